#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::model {

NavState plus(const NavState& state, const ErrorVector& error) {
  NavState out = state;
  out.position += error.segment<3>(kPosition);
  out.velocity += error.segment<3>(kVelocity);
  out.attitude = (state.attitude * so3_exp(error.segment<3>(kAttitude))).normalized();
  out.gyro_bias += error.segment<3>(kGyroBias);
  out.accelerometer_bias += error.segment<3>(kAccelerometerBias);
  out.wheel_scale += error.segment<3>(kWheelScale);
  out.axle += error[kAxle];
  out.course += error.segment<2>(kCourse);
  return out;
}

ErrorVector minus(const NavState& to, const NavState& from) {
  ErrorVector error;
  error << to.position - from.position, to.velocity - from.velocity, so3_log(from.attitude.conjugate() * to.attitude),
      to.gyro_bias - from.gyro_bias, to.accelerometer_bias - from.accelerometer_bias, to.wheel_scale - from.wheel_scale,
      to.axle - from.axle, to.course - from.course;
  return error;
}

template <int Rows>
Eigen::Matrix<double, Rows, Rows> propagated(const Eigen::Matrix<double, Rows, kErrorSize>& J, const ErrorMatrix& P) {
  return J * P * J.transpose();
}
template Eigen::Matrix<double, 6, 6> propagated(const Eigen::Matrix<double, 6, kErrorSize>& J, const ErrorMatrix& P);
template ErrorMatrix propagated(const ErrorMatrix& J, const ErrorMatrix& P);

}  // namespace curbstone::ekf::model
