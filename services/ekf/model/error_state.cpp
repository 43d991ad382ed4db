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

namespace {

/// J M^T, row by row as a sum of columns of M. Most of a Jacobian are zeros, which are left out.
template <int Rows, int Cols>
Eigen::Matrix<double, Rows, Cols> times_transposed(const Eigen::Matrix<double, Rows, kErrorSize>& J,
                                                   const Eigen::Matrix<double, Cols, kErrorSize>& M) {
  Eigen::Matrix<double, Rows, Cols> out;
  for (int row = 0; row < Rows; ++row) {
    Eigen::Matrix<double, Cols, 1> sum = Eigen::Matrix<double, Cols, 1>::Zero();
    for (int k = 0; k < kErrorSize; ++k)
      if (J(row, k) != 0.0) sum += J(row, k) * M.col(k);
    out.row(row) = sum.transpose();
  }
  return out;
}

}  // namespace

template <int Rows>
Eigen::Matrix<double, Rows, Rows> propagated(const Eigen::Matrix<double, Rows, kErrorSize>& J, const ErrorMatrix& P) {
  return times_transposed<Rows, Rows>(J, times_transposed<Rows, kErrorSize>(J, P));
}

void propagate_motion(const ErrorMatrix& F, ErrorMatrix& P) {
  constexpr int kMotion = kGyroBias, kRest = kErrorSize - kMotion;
  const Eigen::Matrix<double, kMotion, kErrorSize> rows = F.topRows<kMotion>();
  const Eigen::Matrix<double, kMotion, kErrorSize> FP = times_transposed<kMotion, kErrorSize>(rows, P);
  P.topLeftCorner<kMotion, kMotion>() = times_transposed<kMotion, kMotion>(rows, FP);
  P.topRightCorner<kMotion, kRest>() = FP.rightCols<kRest>();
  P.bottomLeftCorner<kRest, kMotion>() = FP.rightCols<kRest>().transpose();
}

template Eigen::Matrix<double, 6, 6> propagated(const Eigen::Matrix<double, 6, kErrorSize>& J, const ErrorMatrix& P);
template ErrorMatrix propagated(const ErrorMatrix& J, const ErrorMatrix& P);

}  // namespace curbstone::ekf::model
