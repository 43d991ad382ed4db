#include "common/time/clock.hpp"

#include <chrono>

namespace curbstone {

namespace {
template <class Clock>
std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();
}
}  // namespace

std::int64_t wall_clock() {
  return now_us<std::chrono::system_clock>();
}
std::int64_t steady_clock() {
  return now_us<std::chrono::steady_clock>();
}

}  // namespace curbstone
