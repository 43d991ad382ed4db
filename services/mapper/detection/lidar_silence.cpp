#include "services/mapper/detection/lidar_silence.hpp"

#include <fmt/format.h>

namespace curbstone::mapper::detection {

void LidarSilence::add_faults(std::vector<std::string>& faults) const {
  if (timer_.never_came()) faults.emplace_back("no LIDAR_POINTS");
  if (!timer_.was_heard() || timer_.silent() <= kSilent) return;
  faults.push_back(fmt::format(
      "LiDAR: silent for {:.1f} s: nothing is mapped. Check its cable and power, and the faults of its driver",
      static_cast<double>(timer_.silent()) * 1e-6));
}

}  // namespace curbstone::mapper::detection
