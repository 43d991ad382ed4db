#include "drivers/lidar/models/robosense/speed_watch.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace curbstone::lidar::models::robosense {

std::optional<std::string> SpeedWatch::check(int set, int measured) {
  constexpr int kTolerance = 20;  // a part of this many
  const bool differs = measured != 0 && set != 0 && kTolerance * std::abs(measured - set) > set;
  const bool twice = differs && differed_;
  differed_ = differs;
  if (!twice) return std::nullopt;
  return fmt::format(
      "the head turns at {} rpm and not at the {} that are set: is the device blocked, cold, or about to fail?",
      measured, set);
}

}  // namespace curbstone::lidar::models::robosense
