#include "services/ekf/filter/lost_axes.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/geometry/gravity.hpp"
#include "services/ekf/detection/start_up.hpp"
#include "services/ekf/model/mechanisation.hpp"

namespace curbstone::ekf::filter {

namespace {

constexpr double kTilting = 0.03;   // rad/s, 1 sigma: roll and pitch rates on uneven ground
constexpr double kMemory = 1.0;     // s, correlation time of the rate
constexpr double kUpright = 0.7;    // vertical component of an axis above which it measures the vehicle's turn
constexpr double kLevelling = 1.0;  // s, within which the accelerometer corrects little of a wrong tilt
constexpr double kUnsure = 0.3;     // 1 sigma of the correction, as a share of it

/// 1 sigma of the rate about an axis, rad/s.
double usual_rate(const Eigen::Vector3d& direction) {
  const double level = std::sqrt(std::max(1.0 - direction.z() * direction.z(), 0.0));
  return std::hypot(direction.z() * model::Mechanisation::kUsualTurn, level * kTilting);
}

/// Scales the bias along a direction, with its covariances, by `share`.
void shrink_bias(model::Belief& belief, const Eigen::Vector3d& direction, double share) {
  const Eigen::Matrix3d shrink = Eigen::Matrix3d::Identity() - (1.0 - share) * direction * direction.transpose();
  model::ErrorMatrix& P = belief.covariance;
  belief.mean.gyro_bias = (shrink * belief.mean.gyro_bias).eval();
  P.middleRows<3>(model::kGyroBias) = (shrink * P.middleRows<3>(model::kGyroBias)).eval();
  P.middleCols<3>(model::kGyroBias) = (P.middleCols<3>(model::kGyroBias) * shrink).eval();
}

void widen(model::Belief& belief, model::ErrorIndex index, const Eigen::Vector3d& sigma) {
  belief.covariance.block<3, 3>(index, index) += sigma * sigma.transpose();
}

void set_bias(model::Belief& belief, const Eigen::Vector3d& direction, double bias, double sigma) {
  shrink_bias(belief, direction, 0.0);
  belief.mean.gyro_bias += bias * direction;
  widen(belief, model::kGyroBias, sigma * direction);
}

}  // namespace

base::ImuSample LostAxes::without_lost(base::ImuSample sample) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (watch_.stuck(axis)) sample.angular_rate[axis] = 0.0;
  }
  return sample;
}

base::ImuSample LostAxes::add(const base::ImuSample& sample, bool drives) {
  before_ = sample_;
  sample_ = sample;
  watch_.add(sample.utime, sample.angular_rate, sample.stuck, drives);
  return without_lost(sample);
}

bool LostAxes::update(model::Belief& belief, double wheel_yaw_rate, bool standing, Counters& counters) {
  const double dt = std::clamp(base::seconds_between(before_.utime, sample_.utime), 0.0, config_.timing.max_jump);
  bool changed = false;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const bool stuck = watch_.stuck(axis);
    changed = changed || stuck != lost_[i];
    if (stuck && !lost_[i]) {
      mark_stuck(axis, belief, wheel_yaw_rate);
      counters.add(std::string("faults.gyro_") + "xyz"[i]);
    } else if (stuck) {
      propagate_axis(axis, belief, standing ? 0.0 : dt, dt);
    } else if (lost_[i]) {
      restore_bias(axis, belief);
      counters.add(std::string("trusted.gyro_") + "xyz"[i]);
    } else if (watch_.since(axis) == sample_.utime) {
      bias_[i] = direction(axis).dot(belief.mean.gyro_bias);
      error_[i] = {};
    } else if (!standing) {
      accumulate_error(axis, belief, wheel_yaw_rate, dt);
    }
    lost_[i] = stuck;
  }
  return changed;
}

/// Wheels slip now and then, and by more than their noise allows for: the attitude is widened in addition.
void LostAxes::propagate_axis(int axis, model::Belief& belief, double driving, double dt) const {
  const Eigen::Vector3d d = direction(axis);
  const double share = std::exp(-dt / kMemory);
  shrink_bias(belief, d, share);
  widen(belief, model::kGyroBias, std::sqrt(1.0 - share * share) * usual_rate(d) * d);
  widen(belief, model::kAttitude, std::abs(d.z()) * config_.noise.coasting_rate * std::sqrt(driving) * d);
}

void LostAxes::accumulate_error(int axis, const model::Belief& belief, double wheel_yaw_rate, double dt) {
  const Eigen::Vector3d d = direction(axis);
  AccumulatedError& error = error_[static_cast<std::size_t>(axis)];
  error.angle += dt * (sample_.angular_rate[axis] - d.dot(belief.mean.gyro_bias) - d.z() * wheel_yaw_rate);
  error.position += dt * (belief.mean.attitude * (error.angle * d).cross(belief.mean.velocity));
}

void LostAxes::mark_stuck(int axis, model::Belief& belief, double wheel_yaw_rate) {
  const Eigen::Vector3d d = direction(axis);
  const bool upright = std::abs(d.z()) > kUpright;
  const double seconds = base::seconds_between(watch_.since(axis), sample_.utime);
  AccumulatedError& error = error_[static_cast<std::size_t>(axis)];
  if (!upright && std::abs(error.angle) > config_.start.moving_tilt_sigma) {  // gravity counted as acceleration
    belief.covariance.diagonal().segment<3>(model::kVelocity).array() +=
        std::pow(0.5 * kGravity * error.angle * std::min(seconds, kLevelling), 2);
    detection::reset_accelerometer_bias(belief, config_.start);
  }
  const bool levelled = !upright && seconds > kLevelling;  // the accelerometer has corrected most of it
  if (levelled && std::abs(error.angle) > config_.start.moving_tilt_sigma) {
    error.position *= config_.start.moving_tilt_sigma / std::abs(error.angle);
    error.angle = std::copysign(config_.start.moving_tilt_sigma, error.angle);
  }
  belief.mean.attitude = (belief.mean.attitude * so3_exp(-error.angle * d)).normalized();
  belief.mean.position -= error.position;
  const double by_wheels = config_.noise.coasting_rate * std::sqrt(seconds);
  const double by_ground = kTilting * std::min(seconds, kMemory);
  widen(belief, model::kAttitude, std::hypot(kUnsure * error.angle, upright ? by_wheels : by_ground) * d);
  widen(belief, model::kPosition, kUnsure * error.position);
  set_bias(belief, d, -d.z() * wheel_yaw_rate, usual_rate(d));
  error = {};
}

void LostAxes::restore_bias(int axis, model::Belief& belief) const {
  set_bias(belief, direction(axis), bias_[static_cast<std::size_t>(axis)], config_.start.gyro_bias_sigma);
}

bool LostAxes::yaw_rate_unmeasured() const {
  for (int axis = 0; axis < 3; ++axis) {
    if (lost(axis) && std::abs(direction(axis).z()) > kUpright) return true;
  }
  return false;
}

model::Belief LostAxes::with_restored_biases(model::Belief belief) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (lost(axis)) restore_bias(axis, belief);
  }
  return belief;
}

void LostAxes::restore_biases(model::Estimate& estimate) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (lost(axis)) estimate.gyro_bias[axis] = bias_[static_cast<std::size_t>(axis)];
  }
}

}  // namespace curbstone::ekf::filter
