#include "drivers/lidar/host_clock.hpp"

#include <sys/timex.h>

namespace curbstone::lidar {

bool kernel_clock_is_synchronised() {
  timex state{};  // modes = 0: read only
  const int result = adjtimex(&state);
  return result >= 0 && result != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

}  // namespace curbstone::lidar
