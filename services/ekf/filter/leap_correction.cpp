#include "services/ekf/filter/leap_correction.hpp"

#include <cmath>

namespace curbstone::ekf::filter {

model::Belief without_leap(model::Belief belief, const detection::GyroLeap::Leap& leap) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double turn = leap.rate * leap.seconds;
  const Eigen::Vector3d place = 0.5 * leap.seconds * (belief.mean.attitude * (turn * up).cross(belief.mean.velocity));
  belief.mean.gyro_bias = leap.before.gyro_bias + leap.rate * up;
  belief.mean.accelerometer_bias = leap.before.accelerometer_bias;
  belief.mean.wheel_scale = leap.before.wheel_scale;
  belief.mean.axle = leap.before.axle;
  belief.mean.course = leap.before.course;
  belief.mean.attitude = (belief.mean.attitude * so3_exp(-turn * up)).normalized();
  belief.mean.position -= place;
  // The heading is uncertain by the error of the bias and by the leap's time.
  constexpr double kBegan = 0.05;  // s, 1 sigma
  const double share = std::hypot(leap.sigma / leap.rate, kBegan / leap.seconds);
  belief.covariance(model::kVelocity + 1, model::kVelocity + 1) += std::pow(turn * belief.mean.velocity.x(), 2);
  belief.covariance(model::kGyroBias + 2, model::kGyroBias + 2) += leap.sigma * leap.sigma;
  const Eigen::Vector3d heading = share * turn * (belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ());
  belief.covariance.block<3, 3>(model::kAttitude, model::kAttitude) += heading * heading.transpose();
  belief.covariance.block<3, 3>(model::kPosition, model::kPosition) += share * share * place * place.transpose();
  return belief;
}

model::Belief without_tilt(model::Belief belief, const detection::TiltingGyro::Leap& leap) {
  constexpr double kTilt = 0.015;  // rad, 1 sigma: what shakes the vehicle and the accelerometer within 0.3 s
  constexpr double kSpeed = 0.2;   // m/s, 1 sigma
  constexpr double kWay = 0.02;    // of the way, 1 sigma: of wheels that have not been corrected
  belief.mean = leap.state;
  const auto widen = [&](int index, double sigma) { belief.covariance(index, index) += sigma * sigma; };
  for (int axis = 0; axis < 3; ++axis) {
    widen(model::kVelocity + axis, kSpeed);
    widen(model::kPosition + axis, kWay * leap.way);
  }
  for (int axis = 0; axis < 2; ++axis) {
    widen(model::kAttitude + axis, kTilt);
    widen(model::kGyroBias + axis, kTilt / leap.seconds);
  }
  return belief;
}

}  // namespace curbstone::ekf::filter
