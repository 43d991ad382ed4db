#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/time/silence_timer.hpp"

namespace curbstone::mapper::detection {

/// How long no LIDAR_POINTS have come, by the ticks: in a replay time goes on by the other sensors' messages. Pure; one
/// thread.
class LidarSilence {
 public:
  static constexpr std::int64_t kSilent = 1'000'000;  ///< us

  /// `now`: us.
  void tick(std::int64_t now) { timer_.tick(now); }
  /// Packets have come.
  void heard() { timer_.heard(); }
  void add_faults(std::vector<std::string>& faults) const;

 private:
  SilenceTimer timer_;
};

}  // namespace curbstone::mapper::detection
