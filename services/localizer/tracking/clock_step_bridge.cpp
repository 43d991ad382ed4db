#include "services/localizer/tracking/clock_step_bridge.hpp"

#include <cmath>

namespace curbstone::localizer::tracking {
namespace {

constexpr double kStands = 0.02;            // m in a revolution
constexpr double kUnexpected = 0.3;         // m
constexpr double kUnexpectedTurn = 0.1;     // rad
constexpr double kLongestRevolution = 0.3;  // s

}  // namespace

void ClockStepBridge::clock_was_set(double by) {
  set_by_ = by;
  told_for_ = kTold;
}

void ClockStepBridge::follow(const Pose& T_odom_base, const mapper::scan::Twist& twist, double stride) {
  T_odom_last_ = T_odom_base;
  twist_ = twist;
  stride_ = stride;
  coasted_ = 0;
  if (told_for_ > 0) --told_for_;
}

void ClockStepBridge::coast(double seconds) {
  if (!T_odom_last_) return;
  const double moved_for = seconds > 0 && seconds < kLongestRevolution ? seconds : stride_;
  coasted_ += moved_for;
  *T_odom_last_ = *T_odom_last_ * mapper::scan::move(twist_, moved_for);
  if (coasted_ > kLongest) T_odom_last_.reset();
}

Pose ClockStepBridge::before(const Pose& T_odom_base, double seconds) const {
  return T_odom_base * mapper::scan::move(twist_, -seconds);
}

/// Where in a revolution the clock was set decides how much of one lies between the ends.
std::optional<Pose> ClockStepBridge::motion_to(const Pose& T_odom_base, double seconds) const {
  if (!T_odom_last_) return std::nullopt;
  const Pose motion = T_odom_last_->inverse() * T_odom_base;
  const Pose expected = mapper::scan::move(twist_, stride_);
  const bool is_step = told_for_ > 0 && std::abs(seconds - stride_ - set_by_) < kLongest;
  if (seconds > kLongest && !is_step && expected.translation().norm() < kStands) return std::nullopt;
  const double off = (motion.translation() - expected.translation()).norm();
  const double turned_off = angle_of(expected.inverse() * motion);
  if (off > kUnexpected + expected.translation().norm() || turned_off > kUnexpectedTurn + angle_of(expected))
    return std::nullopt;
  return motion;
}

}  // namespace curbstone::localizer::tracking
