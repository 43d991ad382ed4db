#include "services/ekf/filter/vertical_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/gravity.hpp"

namespace curbstone::ekf::filter {

namespace {

constexpr double kBiasMemory = 30.0;  // s, over which the bias is averaged
constexpr double kMeanMemory = 1.0;   // s, of the reported mean
constexpr double kMaxStep = 0.1;      // s between samples: beyond it what happened between them is not known

}  // namespace

base::ImuSample VerticalForce::usable(base::ImuSample sample, const model::NavState& state,
                                      const model::Geometry& geometry, double noise) {
  const double dt = utime_ ? base::seconds_between(*utime_, sample.utime) : 0.0;
  const bool follows = utime_ && dt > 0.0 && dt <= kMaxStep;
  utime_ = sample.utime;
  if (!follows) return sample;
  const Eigen::Vector3d rate = geometry.R_base_imu * sample.angular_rate - state.gyro_bias;
  const Eigen::Vector3d force = geometry.R_base_imu * sample.acceleration;
  const Eigen::Vector3d gravity = state.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity);
  const double expected = gravity.z() + rate.cross(state.velocity).z();
  if (judge(force.z() - expected, dt, std::max(noise / kQuiet, 1.0), state.velocity.norm())) return sample;
  const Eigen::Vector3d believed(force.x(), force.y(), expected + state.accelerometer_bias.z());
  sample.acceleration = geometry.R_base_imu.transpose() * believed;
  return sample;
}

/// Whether the vertical part may be used. `noisy`: by which the limits are multiplied; `speed`: the vehicle's,
/// m/s.
bool VerticalForce::judge(double excess, double dt, double noisy, double speed) {
  const double beyond = excess - bias_;
  excess_ += std::min(dt / kMeanMemory, 1.0) * (beyond - excess_);
  if (known_for_ >= kKnown) {
    const double allowed = noisy * (kAllowed + kRate * speed);
    speed_ += beyond * dt;
    speed_ = std::copysign(std::max(std::abs(speed_) - allowed * dt, 0.0), speed_);
    const double most = noisy * kMaxSpeed + allowed * kTrust;
    speed_ = std::clamp(speed_, -most, most);
  }
  if (std::abs(speed_) > noisy * kMaxSpeed) {
    replaced_for_ += dt;
    return false;
  }
  replaced_for_ = 0.0;
  known_for_ += dt;
  bias_ += dt / std::min(known_for_, kBiasMemory) * beyond;
  return true;
}

}  // namespace curbstone::ekf::filter
