#include "services/ekf/model/mechanisation.hpp"

#include <algorithm>

namespace curbstone::ekf::model {

namespace {

constexpr double kGapStep = 0.03;   // s: a longer step of the IMU has lost samples
constexpr double kGapNoise = 10.0;  // times the noise in such a step

}  // namespace

void Mechanisation::reset() {
  last_imu_.reset();
  window_.reset();
}

void Mechanisation::advance(Belief& belief, std::int64_t utime, const TimedInertial* next, bool standing) {
  if (utime <= belief.utime) return;
  const double dt = base::seconds_between(belief.utime, utime);
  const bool bracketed = next && last_imu_ && next->utime > last_imu_->utime && imu_at_hand(next->utime);
  if (bracketed) {
    const double whole = base::seconds_between(last_imu_->utime, next->utime);
    const double middle = base::seconds_between(last_imu_->utime, belief.utime) + 0.5 * dt;
    const double f = std::clamp(middle / whole, 0.0, 1.0);
    const Inertial mean{(1.0 - f) * last_imu_->imu.angular_rate + f * next->imu.angular_rate,
                        (1.0 - f) * last_imu_->imu.acceleration + f * next->imu.acceleration};
    step(belief, mean, dt, standing);
  } else {
    coast(belief, dt);
  }
  belief.utime = utime;
}

void Mechanisation::step(Belief& belief, const Inertial& imu, double dt, bool standing) {
  base::NoiseConfig noise = config_.noise;
  if (dt > kGapStep) {
    noise.gyro *= kGapNoise;
    noise.accelerometer *= kGapNoise;
  }
  const BodyMotion before = body_motion(belief.mean, imu.angular_rate, geometry_);
  if (standing)
    predict_standing(belief, imu, dt, noise);
  else
    predict(belief, imu, dt, noise);
  const BodyMotion after = body_motion(belief.mean, imu.angular_rate, geometry_);
  const double gained = after.velocity.x() - before.velocity.x();
  window_.add(dt, {0.5 * (before.velocity + after.velocity), before.angular_rate}, imu, inertial_speed_ + 0.5 * gained);
  inertial_speed_ += gained;
}

void Mechanisation::coast(Belief& belief, double dt) {
  const Eigen::Vector3d rate(0, 0, wheel_yaw_rate());
  predict_coasting(belief, wheel_yaw_rate(), dt, config_.noise);
  if (!wheel_yaw_rate_) {
    const Eigen::Vector3d up = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
    belief.covariance.block<3, 3>(kAttitude, kAttitude) += kUsualTurn * kUsualTurn * dt * up * up.transpose();
  }
  const Eigen::Vector3d gyro = belief.mean.gyro_bias + rate;
  const Eigen::Vector3d steady =
      belief.mean.accelerometer_bias + belief.mean.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity);
  window_.add(dt, body_motion(belief.mean, gyro, geometry_), {gyro, steady}, inertial_speed_);
}

}  // namespace curbstone::ekf::model
