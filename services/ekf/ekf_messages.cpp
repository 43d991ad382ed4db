#include "services/ekf/ekf_messages.hpp"

#include <cmath>

namespace curbstone::ekf {

namespace {

constexpr double kMaxRate = 70.0;                          // rad/s: 4000 deg/s, twice the range of such sensors
constexpr double kMaxAcceleration = 400.0;                 // m/s^2: 40 g, likewise
constexpr double kMaxAngle = 1e9;                          // rad: beyond it differences lose their last digits
constexpr std::int64_t kMaxStamp = 4'102'444'800'000'000;  // us: the year 2100

bool plausible_stamp(std::int64_t utime) {
  return utime > 0 && utime < kMaxStamp;
}

Eigen::Vector3d vector(const double v[3]) {
  return {v[0], v[1], v[2]};
}

void copy(const Eigen::Vector3d& from, double to[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

void copy(const Eigen::Matrix<double, 6, 6>& from, float to[36]) {
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) to[6 * row + column] = static_cast<float>(from(row, column));
}

}  // namespace

const char* why_refused(const imu_t& message) {
  if (!plausible_stamp(message.utime)) return "stamp";
  const Eigen::Vector3d rate = vector(message.angular_rate);
  const Eigen::Vector3d acceleration = vector(message.acceleration);
  if (!rate.allFinite() || !acceleration.allFinite()) return "not_finite";
  if (rate.cwiseAbs().maxCoeff() > kMaxRate || acceleration.cwiseAbs().maxCoeff() > kMaxAcceleration) return "absurd";
  return nullptr;
}

const char* why_refused(const wheels_t& message) {
  if (!plausible_stamp(message.utime)) return "stamp";
  for (const double angle : message.angle) {
    if (!std::isfinite(angle)) return "not_finite";
    if (std::abs(angle) > kMaxAngle) return "absurd";
  }
  return nullptr;
}

base::ImuSample sample_of(const imu_t& message) {
  const auto says = [&](std::int32_t bit) { return (message.status & bit) != 0; };
  return {message.utime,
          vector(message.angular_rate),
          vector(message.acceleration),
          {says(imu_t::GYRO_X_STUCK), says(imu_t::GYRO_Y_STUCK), says(imu_t::GYRO_Z_STUCK)}};
}

base::WheelSample sample_of(const wheels_t& message) {
  return {message.utime, {message.angle[wheels_t::LEFT], message.angle[wheels_t::RIGHT]}};
}

odometry_t odometry_message(const model::Estimate& estimate) {
  odometry_t out{};
  out.utime = estimate.utime;
  pose_to_arrays(estimate.T_odom_base, out.position, out.orientation);
  copy(estimate.velocity, out.velocity);
  copy(estimate.angular_rate, out.angular_rate);
  copy(estimate.gyro_bias, out.gyro_bias);
  copy(estimate.accelerometer_bias, out.accelerometer_bias);
  copy(estimate.pose_covariance, out.pose_covariance);
  copy(estimate.twist_covariance, out.twist_covariance);
  out.flags |= estimate.level ? std::int32_t{odometry_t::INITIALISED} : std::int32_t{odometry_t::NOT_LEVEL};
  if (estimate.stationary) out.flags |= odometry_t::STATIONARY;
  if (estimate.slipping) out.flags |= odometry_t::SLIPPING;
  if (estimate.no_imu) out.flags |= odometry_t::NO_IMU;
  if (estimate.no_wheels) out.flags |= odometry_t::NO_WHEELS;
  if (estimate.turn_confirmed) out.flags |= odometry_t::TURN_CONFIRMED;
  return out;
}

pose_t pose_message(const model::Estimate& estimate) {
  const Eigen::Matrix3d R = estimate.T_odom_base.linear();
  pose_t out{};
  out.utime = estimate.utime;
  pose_to_arrays(estimate.T_odom_base, out.pos, out.orientation);
  copy(R * estimate.velocity, out.vel);
  copy(R * estimate.angular_rate, out.rotation_rate);
  copy(estimate.acceleration, out.accel);
  return out;
}

}  // namespace curbstone::ekf
