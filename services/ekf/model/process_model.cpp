#include "services/ekf/model/process_model.hpp"

namespace curbstone::ekf::model {

namespace {

const Eigen::Vector3d kGravityVector(0, 0, -kGravity);

/// Right Jacobian of SO(3): exp(phi + d) = exp(phi) exp(J d). Second order suffices for one step's angle.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi) {
  const Eigen::Matrix3d x = skew(phi);
  return Eigen::Matrix3d::Identity() - 0.5 * x + x * x / 6.0;
}

void symmetrise(ErrorMatrix& p) {
  p = (0.5 * (p + p.transpose())).eval();
}

void add_random_walks(ErrorMatrix& p, double dt, const base::NoiseConfig& noise) {
  const auto add = [&](int index, double density) { p.diagonal().segment<3>(index).array() += density * density * dt; };
  add(kGyroBias, noise.gyro_bias_walk);
  add(kAccelerometerBias, noise.accelerometer_bias_walk);
  add(kWheelScale, noise.wheel_scale_walk);
}

}  // namespace

NavState integrate(const NavState& state, const Inertial& imu, double dt) {
  const Eigen::Vector3d w = imu.angular_rate - state.gyro_bias;
  const Eigen::Vector3d a = imu.acceleration - state.accelerometer_bias;
  const Eigen::Matrix3d R = state.attitude.toRotationMatrix();
  const Eigen::Quaterniond E = so3_exp(w * dt);
  const Eigen::Quaterniond H = so3_exp(0.5 * w * dt);

  NavState next = state;
  next.attitude = (state.attitude * E).normalized();
  next.velocity =
      E.conjugate() * state.velocity + dt * (H.conjugate() * a) + dt * (next.attitude.conjugate() * kGravityVector);
  next.position += dt * (R * state.velocity) + 0.5 * dt * dt * (R * (H * a) + kGravityVector);
  return next;
}

ErrorMatrix transition(const NavState& state, const Inertial& imu, double dt) {
  const Eigen::Vector3d w = imu.angular_rate - state.gyro_bias;
  const Eigen::Vector3d a = imu.acceleration - state.accelerometer_bias;
  const Eigen::Matrix3d R = state.attitude.toRotationMatrix();
  const Eigen::Matrix3d E = so3_exp(w * dt).toRotationMatrix();
  const Eigen::Matrix3d H = so3_exp(0.5 * w * dt).toRotationMatrix();
  const Eigen::Matrix3d turn = dt * right_jacobian(w * dt);  // derivative of E by the rate: E exp(turn dw)
  const Eigen::Matrix3d half_turn = 0.5 * dt * right_jacobian(0.5 * w * dt);
  const Eigen::Matrix3d gravity = dt * skew(E.transpose() * (R.transpose() * kGravityVector));  // dv' / dtheta'

  ErrorMatrix F = ErrorMatrix::Identity();
  F.block<3, 3>(kAttitude, kAttitude) = E.transpose();
  F.block<3, 3>(kAttitude, kGyroBias) = -turn;

  F.block<3, 3>(kVelocity, kVelocity) = E.transpose();
  F.block<3, 3>(kVelocity, kAttitude) = gravity * E.transpose();
  F.block<3, 3>(kVelocity, kGyroBias) =
      -skew(E.transpose() * state.velocity) * turn - dt * skew(H.transpose() * a) * half_turn - gravity * turn;
  F.block<3, 3>(kVelocity, kAccelerometerBias) = -dt * H.transpose();

  F.block<3, 3>(kPosition, kVelocity) = dt * R;
  F.block<3, 3>(kPosition, kAttitude) = -dt * R * skew(state.velocity) - 0.5 * dt * dt * R * skew(H * a);
  F.block<3, 3>(kPosition, kGyroBias) = 0.5 * dt * dt * R * H * skew(a) * half_turn;
  F.block<3, 3>(kPosition, kAccelerometerBias) = -0.5 * dt * dt * R * H;
  return F;
}

void predict(Belief& belief, const Inertial& imu, double dt, const base::NoiseConfig& noise) {
  const ErrorMatrix F = transition(belief.mean, imu, dt);
  const auto by_gyro = F.middleCols<3>(kGyroBias).topRows<9>();
  const auto by_accelerometer = F.middleCols<3>(kAccelerometerBias).topRows<9>();
  ErrorMatrix& P = belief.covariance;
  propagate_motion(F, P);
  P.topLeftCorner<9, 9>() +=
      (noise.gyro * noise.gyro / dt) * by_gyro * by_gyro.transpose() +
      (noise.accelerometer * noise.accelerometer / dt) * by_accelerometer * by_accelerometer.transpose();
  add_random_walks(P, dt, noise);
  symmetrise(P);
  belief.mean = integrate(belief.mean, imu, dt);
}

void predict_standing(Belief& belief, const Inertial& imu, double dt, const base::NoiseConfig& noise) {
  // The gyro's reading is set to its bias, and in the error state the bias does not affect the motion.
  const Inertial not_turning{belief.mean.gyro_bias, imu.acceleration};
  ErrorMatrix F = transition(belief.mean, not_turning, dt);
  F.middleCols<3>(kGyroBias).topRows<9>().setZero();
  F.middleRows<3>(kPosition).setZero();
  F.block<3, 3>(kPosition, kPosition).setIdentity();
  const auto by_accelerometer = F.middleCols<3>(kAccelerometerBias).topRows<9>();
  ErrorMatrix& P = belief.covariance;
  propagate_motion(F, P);
  P.topLeftCorner<9, 9>() +=
      (noise.accelerometer * noise.accelerometer / dt) * by_accelerometer * by_accelerometer.transpose();
  add_random_walks(P, dt, noise);
  symmetrise(P);
  const Eigen::Vector3d position = belief.mean.position;
  belief.mean = integrate(belief.mean, not_turning, dt);
  belief.mean.position = position;
}

void predict_coasting(Belief& belief, double yaw_rate, double dt, const base::NoiseConfig& noise) {
  const Eigen::Vector3d w(0, 0, yaw_rate);
  const Eigen::Matrix3d R = belief.mean.attitude.toRotationMatrix();
  const Eigen::Quaterniond E = so3_exp(w * dt);

  ErrorMatrix F = ErrorMatrix::Identity();
  F.block<3, 3>(kAttitude, kAttitude) = E.toRotationMatrix().transpose();
  F.block<3, 3>(kPosition, kVelocity) = dt * R;
  F.block<3, 3>(kPosition, kAttitude) = -dt * R * skew(belief.mean.velocity);
  ErrorMatrix& P = belief.covariance;
  propagate_motion(F, P);
  const double turning = noise.coasting_rate * noise.coasting_rate * dt;
  const double speeding = noise.coasting_acceleration * noise.coasting_acceleration * dt;
  P.diagonal().segment<3>(kAttitude).array() += turning;
  P.diagonal().segment<3>(kVelocity).array() += speeding;
  add_random_walks(P, dt, noise);
  symmetrise(P);

  belief.mean.position += dt * (R * (so3_exp(0.5 * dt * w) * belief.mean.velocity));
  belief.mean.attitude = (belief.mean.attitude * E).normalized();
}

}  // namespace curbstone::ekf::model
