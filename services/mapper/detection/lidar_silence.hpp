#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::mapper::detection {

/// How long no LIDAR_POINTS have come, by the ticks: in a replay time goes on by the other sensors' messages. A process
/// that was stopped sees one long tick, and the messages may wait behind it: a tick counts for kMostPerTick at most.
/// Pure; one thread.
class LidarSilence {
 public:
  static constexpr std::int64_t kSilent = 1'000'000;     ///< us
  static constexpr std::int64_t kMostPerTick = 500'000;  ///< us

  /// `now`: us.
  void tick(std::int64_t now);
  /// Packets have come.
  void heard();
  void add_faults(std::vector<std::string>& faults) const;

 private:
  bool was_heard_ = false;
  std::int64_t ticked_ = 0;  // us
  std::int64_t silent_ = 0;  // us
};

}  // namespace curbstone::mapper::detection
