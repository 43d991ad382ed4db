#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/statistics/quantile.hpp"

namespace curbstone::mapper::detection {

/// Whether registration and odometry turn the same way. Takes the poses of registration before they are accepted: those
/// of a LiDAR whose azimuths are mirrored are refused as soon as the vehicle turns. Compares stretches of half a second
/// in which odometry turns by kMinTurn or more. Pure; one thread.
class TurnSense {
 public:
  static constexpr std::int64_t kStretch = 500'000;  ///< us
  static constexpr std::int64_t kGap = 300'000;      ///< us between two revolutions, at most
  static constexpr double kMinTurn = 0.01;           ///< rad: ten times what registration is off by
  static constexpr std::size_t kMinStretches = 4;
  static constexpr std::size_t kStretches = 9;
  static constexpr double kOpposite = -0.5;  ///< registration's turn by odometry's

  /// Takes the next revolution: its pose by registration, accepted or not, and by odometry.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
    if (last_ && (utime <= *last_ || utime - *last_ > kGap)) begin_.reset();
    last_ = utime;
    if (!begin_) begin_ = Begin{utime, T_map_base, T_odom_base};
    if (utime - begin_->utime < kStretch) return;
    const double by_odometry = yaw_of(begin_->T_odom_base.inverse() * T_odom_base);
    const double by_scans = yaw_of(begin_->T_map_base.inverse() * T_map_base);
    begin_ = Begin{utime, T_map_base, T_odom_base};
    if (std::abs(by_odometry) < kMinTurn) return;
    ratios_.push_back(by_scans / by_odometry);
    if (ratios_.size() > kStretches) ratios_.pop_front();
  }
  /// The poses that follow do not continue those before.
  void interrupt() { begin_.reset(); }
  /// Three stretches in four and more say so.
  [[nodiscard]] bool is_opposite() const {
    return ratios_.size() >= kMinStretches && quantile_or({ratios_.begin(), ratios_.end()}, 0.75, 1.0) < kOpposite;
  }

 private:
  struct Begin {
    std::int64_t utime;  // us
    Pose T_map_base, T_odom_base;
  };
  static double yaw_of(const Pose& motion) { return std::atan2(motion.linear()(1, 0), motion.linear()(0, 0)); }

  std::optional<std::int64_t> last_;  // us
  std::optional<Begin> begin_;
  std::deque<double> ratios_;
};

}  // namespace curbstone::mapper::detection
