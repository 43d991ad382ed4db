#pragma once

#include <Eigen/Cholesky>

#include "services/ekf/error_state.hpp"

namespace curbstone {

/// A measurement compared with what the filter expected: residual = measured - expected = H error + noise(0, R).
template <int Rows>
struct Observation {
  Eigen::Matrix<double, Rows, 1> residual = Eigen::Matrix<double, Rows, 1>::Zero();
  Eigen::Matrix<double, Rows, kErrorSize> H = Eigen::Matrix<double, Rows, kErrorSize>::Zero();
  Eigen::Matrix<double, Rows, Rows> R = Eigen::Matrix<double, Rows, Rows>::Zero();
};

/// Squared Mahalanobis distance of the residual: chi-square with `Rows` degrees of freedom if the filter is honest.
template <int Rows>
[[nodiscard]] double distance(const Belief& belief, const Observation<Rows>& z) {
  const Eigen::Matrix<double, Rows, Rows> S = z.H * belief.covariance * z.H.transpose() + z.R;
  return z.residual.dot(S.ldlt().solve(z.residual));
}

/// The gain that is optimal for every component of the error.
template <int Rows>
[[nodiscard]] Eigen::Matrix<double, kErrorSize, Rows> optimal_gain(const Belief& belief, const Observation<Rows>& z) {
  const Eigen::Matrix<double, kErrorSize, Rows> PHt = belief.covariance * z.H.transpose();
  const Eigen::Matrix<double, Rows, Rows> S = z.H * PHt + z.R;
  return S.ldlt().solve(PHt.transpose()).transpose();
}

/// The gain that leaves position and heading alone. A better speed, scale or gyro bias would move them by what they
/// have gone astray since the start, all at once and even at a standstill; but odom has to be continuous (REP-105), and
/// whoever maps with it wants its increments, not its place. They are the integral of the rest, and drift.
template <int Rows>
[[nodiscard]] Eigen::Matrix<double, kErrorSize, Rows> continuous_gain(const Belief& belief,
                                                                      const Observation<Rows>& z) {
  Eigen::Matrix<double, kErrorSize, Rows> K = optimal_gain(belief, z);
  const Eigen::Vector3d yaw_axis = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  K.template middleRows<3>(kPosition).setZero();
  K.template middleRows<3>(kAttitude) -=
      (yaw_axis * (yaw_axis.transpose() * K.template middleRows<3>(kAttitude))).eval();
  return K;
}

/// Kalman update by any gain. Joseph's form holds for all of them, and keeps the covariance positive where the short
/// form rounds it away.
template <int Rows>
void correct(Belief& belief, const Observation<Rows>& z, const Eigen::Matrix<double, kErrorSize, Rows>& K) {
  ErrorMatrix& P = belief.covariance;
  const ErrorMatrix I_KH = ErrorMatrix::Identity() - K * z.H;
  P = (I_KH * P * I_KH.transpose() + K * z.R * K.transpose()).eval();
  P = (0.5 * (P + P.transpose())).eval();
  belief.mean = plus(belief.mean, K * z.residual);
}

/// Two independent observations as one: applied together they share the same linearisation.
template <int A, int B>
[[nodiscard]] Observation<A + B> stack(const Observation<A>& a, const Observation<B>& b) {
  Observation<A + B> z;
  z.residual << a.residual, b.residual;
  z.H << a.H, b.H;
  z.R.template topLeftCorner<A, A>() = a.R;
  z.R.template bottomRightCorner<B, B>() = b.R;
  return z;
}

/// A gate that cannot lock the filter out: an observation farther off than `gate` keeps its direction and loses its
/// weight, the more so the farther it is. Says whether it lay inside.
template <int Rows>
[[nodiscard]] bool soften_beyond(double gate, const Belief& belief, Observation<Rows>& z) {
  const double d = distance(belief, z);
  if (d <= gate) return true;
  z.R *= d / gate;
  return false;
}

/// Chi-square quantiles at 99.9 %, for 1, 3 and 6 degrees of freedom.
inline constexpr double kGate1 = 10.83;
inline constexpr double kGate3 = 16.27;
inline constexpr double kGate6 = 22.46;

}  // namespace curbstone
