#pragma once

#include <algorithm>
#include <cstdint>

namespace curbstone::procman::process {

/// Back-off before a command that ended is started again, as in procman. It doubles, from 10 ms up to 1 s, each time
/// the command ends within a second, and halves for each whole second that the command ran.
class Backoff {
 public:
  static constexpr std::int64_t kMin = 10'000;     ///< us
  static constexpr std::int64_t kMax = 1'000'000;  ///< us

  /// `lived`: us from start to end. Returns the time to wait, us.
  std::int64_t next(std::int64_t lived) {
    const std::int64_t seconds = std::clamp<std::int64_t>(lived / 1'000'000, 0, 20);
    delay_ = seconds == 0 ? std::min(delay_ * 2, kMax) : std::max(delay_ >> seconds, kMin);
    return delay_;
  }
  void reset() { delay_ = kMin; }

 private:
  std::int64_t delay_ = kMin;
};

}  // namespace curbstone::procman::process
