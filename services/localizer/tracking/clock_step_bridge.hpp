#pragma once

#include <optional>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/deskew.hpp"

namespace curbstone::localizer::tracking {

/// The way over a step of the host's clock, which sets the stamps of all sensors and moves nothing: odometry's poses
/// continue from one revolution to the next as they did, whatever the stamps say. After a silence of all sensors they
/// do not, unless the vehicle stood: then only who is told that the clock was set can tell a step forward from a
/// silence. Pure; one thread; times in s.
class ClockStepBridge {
 public:
  static constexpr double kLongest = 0.3;  ///< without odometry: its filter takes that long to follow the clock

  /// The host's clock was set, forward by so much if positive; its sensors' stamps follow within kTold revolutions.
  void clock_was_set(double by);
  /// After a revolution with odometry: its pose at the end, and the motion, of which the last `stride` is known.
  void follow(const Pose& T_odom_base, const mapper::scan::Twist& twist, double stride);
  /// After a revolution without, in which the vehicle is assumed to have moved on for `seconds`; if they are negative
  /// or many, the clock was set.
  void coast(double seconds);
  /// The pose in odom `seconds` before a known one.
  [[nodiscard]] Pose before(const Pose& T_odom_base, double seconds) const;
  /// The motion to this pose since the last revolution, `seconds` by the stamps, if it continues the motion of one
  /// revolution.
  [[nodiscard]] std::optional<Pose> motion_to(const Pose& T_odom_base, double seconds) const;
  [[nodiscard]] const mapper::scan::Twist& twist() const { return twist_; }
  [[nodiscard]] double stride() const { return stride_; }

 private:
  static constexpr int kTold = 40;  // revolutions

  std::optional<Pose> T_odom_last_;
  mapper::scan::Twist twist_;
  double stride_ = 0;
  double set_by_ = 0;   // s, by which the clock was set
  int told_for_ = 0;    // revolutions for which that counts still
  double coasted_ = 0;  // s since the last revolution with odometry
};

}  // namespace curbstone::localizer::tracking
