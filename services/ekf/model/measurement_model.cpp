#include "services/ekf/model/measurement_model.hpp"

namespace curbstone::ekf::model {

namespace {

using Row = Eigen::Matrix<double, 1, kErrorSize>;

/// Derivative of base_link's velocity by the error: d(v + (gyro - bg) x l) = dv + l x dbg.
Eigen::Matrix<double, 3, kErrorSize> velocity_jacobian(const Geometry& geometry) {
  Eigen::Matrix<double, 3, kErrorSize> H = Eigen::Matrix<double, 3, kErrorSize>::Zero();
  H.block<3, 3>(0, kVelocity).setIdentity();
  H.block<3, 3>(0, kGyroBias) = skew(geometry.to_base);
  return H;
}

}  // namespace

BodyMotion body_motion(const NavState& state, const Eigen::Vector3d& gyro, const Geometry& geometry) {
  const Eigen::Vector3d w = gyro - state.gyro_bias;
  return {state.velocity + w.cross(geometry.to_base), w};
}

double wheel_yaw_rate(const NavState& state, const std::array<double, 2>& speed, const Geometry& geometry) {
  const Eigen::Vector3d& s = state.wheel_scale;
  return (speed[1] * (1.0 + s[1]) - speed[0] * (1.0 + s[0])) / (geometry.track_width * (1.0 + s[2]));
}

Observation observe_wheel(const NavState& state, const BodyMotion& motion, Wheel wheel, double speed, double sigma,
                          const Geometry& geometry) {
  const int index = static_cast<int>(wheel);
  const double arm = (wheel == Wheel::kLeft ? -0.5 : 0.5) * geometry.track_width;
  const double track = 1.0 + state.wheel_scale[2];
  const double radius = 1.0 + state.wheel_scale[index];
  const double over_ground = motion.velocity.x() + motion.angular_rate.z() * arm * track;

  Observation z(1);
  z.residual[0] = speed - over_ground / radius;
  z.H = velocity_jacobian(geometry).row(0) / radius;
  z.H(0, kGyroBias + 2) -= arm * track / radius;
  z.H(0, kWheelScale + index) = -over_ground / (radius * radius);
  z.H(0, kWheelScale + 2) = motion.angular_rate.z() * arm / radius;
  z.R(0, 0) = sigma * sigma;
  return z;
}

Observation observe_no_motion_along(int axis, const NavState& state, const BodyMotion& motion, double sigma,
                                    const Geometry& geometry) {
  const Eigen::Vector3d arm(state.axle, 0.0, 0.0);
  Observation z(1);
  const double course = state.course[axis - 1];
  z.residual[0] = course * motion.velocity.x() - (motion.velocity + motion.angular_rate.cross(arm))[axis];
  z.H = velocity_jacobian(geometry).row(axis) - course * velocity_jacobian(geometry).row(0);
  z.H.middleCols<3>(kGyroBias) += skew(arm).row(axis);
  if (axis == 1) z.H(0, kAxle) = motion.angular_rate.z();
  z.H(0, kCourse + axis - 1) = -motion.velocity.x();
  z.R(0, 0) = sigma * sigma;
  return z;
}

Observation observe_increment(const Pose& T_begin_end, const Eigen::Matrix<double, 6, 6>& covariance,
                              const Pose& believed, double dt, const BodyMotion& motion, const Geometry& geometry) {
  const Eigen::Matrix3d R = believed.linear().transpose();
  const Eigen::Matrix3d halfway = so3_exp(-0.5 * dt * motion.angular_rate).toRotationMatrix();  // to the end's axes
  Observation z(6);
  z.residual << R * (T_begin_end.translation() - believed.translation()),
      so3_log(Eigen::Quaterniond(R * T_begin_end.linear()));
  z.H.topRows<3>() = dt * halfway * velocity_jacobian(geometry);
  z.H.block<3, 3>(0, kGyroBias) += 0.5 * dt * dt * halfway * skew(motion.velocity);  // the turn bends the path
  z.H.block<3, 3>(3, kGyroBias) = -dt * halfway;
  z.R = covariance;
  return z;
}

Observation observe_forward_speed(const NavState& state, const BodyMotion& motion, double speed, double sigma) {
  const double radius = 1.0 + 0.5 * (state.wheel_scale[0] + state.wheel_scale[1]);
  Observation z(1);
  z.residual[0] = speed - motion.velocity.x() / radius;
  z.H(0, kVelocity) = 1.0 / radius;
  z.H(0, kWheelScale) = z.H(0, kWheelScale + 1) = -0.5 * motion.velocity.x() / (radius * radius);
  z.R(0, 0) = sigma * sigma;
  return z;
}

Observation observe_standing_velocity(const NavState& state, double sigma) {
  Observation z(3);
  z.residual = -state.velocity;
  z.H.block<3, 3>(0, kVelocity).setIdentity();
  z.R.diagonal().setConstant(sigma * sigma);
  return z;
}

Observation observe_standing_rate(const NavState& state, const Eigen::Vector3d& gyro, double sigma) {
  Observation z(3);
  z.residual = gyro - state.gyro_bias;
  z.H.block<3, 3>(0, kGyroBias).setIdentity();
  z.R.diagonal().setConstant(sigma * sigma);
  return z;
}

Observation observe_gravity(const NavState& state, const Eigen::Vector3d& specific_force,
                            const Eigen::Vector3d& acceleration, double sigma) {
  const Eigen::Vector3d up = state.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity);
  Observation z(3);
  z.residual = specific_force - (acceleration + up + state.accelerometer_bias);
  z.H.block<3, 3>(0, kAttitude) = skew(up);
  z.H.block<3, 3>(0, kAccelerometerBias).setIdentity();
  z.R.diagonal().setConstant(sigma * sigma);
  return z;
}

}  // namespace curbstone::ekf::model
