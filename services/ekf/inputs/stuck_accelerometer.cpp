#include "services/ekf/inputs/stuck_accelerometer.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::inputs {

namespace {

constexpr double kMaxDistance = 1.0;  // m between two samples: beyond it the counter restarted

}  // namespace

void StuckAccelerometer::add(const base::WheelSample& sample) {
  if (has_wheels_) {
    // A single wheel that turns may spin, or its counts may be made up.
    const double least = std::min(std::abs(sample.angle[0] - angle_[0]), std::abs(sample.angle[1] - angle_[1]));
    if (wheel_radius_ * least < kMaxDistance) way_ += wheel_radius_ * least;
  }
  angle_ = sample.angle;
  has_wheels_ = true;
}

bool StuckAccelerometer::add(const base::ImuSample& sample) {
  for (std::size_t i = 0; i < axis_.size(); ++i) {
    Axis& axis = axis_[i];
    const double force = sample.acceleration[static_cast<Eigen::Index>(i)];
    const bool repeats = has_imu_ && force == axis.shown;
    if (!repeats) {
      if (!has_imu_ || axis.repeats >= kRun) axis.moved = sample.utime;
      axis.shown = force;
      axis.repeats = 0;
      axis.since = way_;
      if (stuck_[i] && sample.utime - axis.moved >= kTrust) stuck_[i] = false;
      continue;
    }
    if (++axis.repeats >= kRun && way_ - axis.since >= kWay) stuck_[i] = true;
  }
  has_imu_ = true;
  return stuck();
}

}  // namespace curbstone::ekf::inputs
