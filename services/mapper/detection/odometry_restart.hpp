#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace curbstone::mapper::detection {

/// Whether the filter of odometry was restarted a moment ago. A restarted filter continues from the state that its
/// predecessor saved, without knowledge of the gap, and needs time to settle. Until then its motion is no reference for
/// the LiDAR. Pure.
class OdometryRestart {
 public:
  static constexpr std::int64_t kStep = 60'000;        ///< us: no filter pauses for so long between two samples,
  static constexpr double kSteps = 2.5;                ///< or so many steps of a slower one
  static constexpr std::int64_t kSettles = 5'000'000;  ///< us

  /// Takes the end of the next revolution, us, and the longest step of odometry shortly before it, us.
  void add(std::int64_t utime, std::int64_t longest_step) {
    usual_step_ = std::min(usual_step_, std::max<std::int64_t>(longest_step, 1));
    if (longest_step > kStep && static_cast<double>(longest_step) > kSteps * static_cast<double>(usual_step_))
      at_ = utime;
    if (utime - at_ >= kSettles || utime < at_) at_ = 0;
  }
  [[nodiscard]] bool is_recent() const { return at_ != 0; }

 private:
  std::int64_t usual_step_ = std::numeric_limits<std::int64_t>::max();  // us
  std::int64_t at_ = 0;                                                 // us; 0: long ago
};

}  // namespace curbstone::mapper::detection
