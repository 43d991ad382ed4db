#pragma once

#include <cstdint>

namespace curbstone {

/// Stamp and number of a MAP_POSE.
struct PoseStamp {
  std::int64_t utime = 0;  ///< us
  std::int32_t revolution = 0;
};

/// Whether `last`, which was heard before this pose, is newer. A newer revolution at an earlier time means that the
/// host's clock was set back, and so does a delay that no message has.
[[nodiscard]] inline bool is_overtaken(const PoseStamp& pose, const PoseStamp& last) {
  constexpr std::int64_t kLatest = 10'000'000;  // us: no MAP_POSE comes later
  return pose.utime <= last.utime && pose.revolution <= last.revolution && last.utime - pose.utime < kLatest;
}

}  // namespace curbstone
