#include "services/ekf/model/correction.hpp"

#include <algorithm>

#include "common/linear/decompositions.hpp"

namespace curbstone::ekf::model {

namespace {

/// P H^T, column by column as a sum of columns of P. Most of H are zeros, which are left out. Here and below Eigen's
/// general product would take most of the filter's time, to compile and to run: it packs factors of any size first.
Gain covariance_with(const Observation& z, const ErrorMatrix& P) {
  Gain PHt(kErrorSize, z.H.rows());
  for (Eigen::Index row = 0; row < z.H.rows(); ++row) {
    ErrorVector sum = ErrorVector::Zero();
    for (int k = 0; k < kErrorSize; ++k)
      if (z.H(row, k) != 0.0) sum += z.H(row, k) * P.col(k);
    PHt.col(row) = sum;
  }
  return PHt;
}

/// K x, with x of as many rows as the observation has.
template <class Vector>
ErrorVector combined(const Gain& K, const Vector& x) {
  ErrorVector sum = ErrorVector::Zero();
  for (Eigen::Index row = 0; row < K.cols(); ++row) sum += x(row) * K.col(row);
  return sum;
}

/// Inverse of H P H^T + R, the covariance of the residual.
SmallMatrix residual_information(const Observation& z, const Gain& PHt) {
  SmallMatrix S = z.R;
  for (Eigen::Index i = 0; i < S.rows(); ++i)
    for (Eigen::Index j = 0; j < S.cols(); ++j) {
      double sum = 0.0;
      for (int k = 0; k < kErrorSize; ++k) sum += z.H(i, k) * PHt(k, j);
      S(i, j) += sum;
    }
  return inverse_of_symmetric(S);
}

}  // namespace

Observation::Observation(int rows)
    : residual(Residual::Zero(rows)), H(Jacobian::Zero(rows, kErrorSize)), R(Noise::Zero(rows, rows)) {}

double squared_mahalanobis(const Belief& belief, const Observation& z) {
  const SmallMatrix information = residual_information(z, covariance_with(z, belief.covariance));
  double sum = 0.0;
  for (Eigen::Index j = 0; j < information.cols(); ++j)
    for (Eigen::Index i = 0; i < information.rows(); ++i) sum += z.residual[i] * information(i, j) * z.residual[j];
  return sum;
}

Gain optimal_gain(const Belief& belief, const Observation& z) {
  const Gain PHt = covariance_with(z, belief.covariance);
  const SmallMatrix information = residual_information(z, PHt);
  Gain K(kErrorSize, z.H.rows());
  for (Eigen::Index row = 0; row < K.cols(); ++row) K.col(row) = combined(PHt, information.col(row));
  return K;
}

Gain guarded_gain(const Belief& belief, const Observation& z) {
  Gain K = optimal_gain(belief, z);
  const Eigen::Vector3d up = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  const auto of_bias = belief.covariance.middleCols<3>(kGyroBias);
  const double variance = std::max(up.dot(of_bias.middleRows<3>(kGyroBias) * up), 1e-18);
  const Eigen::Vector3d place_by_bias = of_bias.middleRows<3>(kPosition) * up / variance;
  K.middleRows<3>(kPosition) = (place_by_bias * (up.transpose() * K.middleRows<3>(kGyroBias))).eval();
  return K;
}

void correct(Belief& belief, const Observation& z, const Gain& K) {
  ErrorMatrix& P = belief.covariance;
  ErrorMatrix I_KH = ErrorMatrix::Identity();
  for (int k = 0; k < kErrorSize; ++k)
    for (Eigen::Index row = 0; row < K.cols(); ++row)
      if (z.H(row, k) != 0.0) I_KH.col(k) -= z.H(row, k) * K.col(row);
  Gain KR(kErrorSize, K.cols());
  for (Eigen::Index row = 0; row < K.cols(); ++row) KR.col(row) = combined(K, z.R.col(row));
  P = propagated(I_KH, P);
  for (int k = 0; k < kErrorSize; ++k) P.col(k) += combined(KR, K.row(k));
  P = (0.5 * (P + P.transpose())).eval();
  belief.mean = plus(belief.mean, combined(K, z.residual));
}

Observation stack(const Observation& a, const Observation& b) {
  const auto rows = a.residual.size();
  Observation z(static_cast<int>(rows + b.residual.size()));
  z.residual << a.residual, b.residual;
  z.H << a.H, b.H;
  z.R.topLeftCorner(rows, rows) = a.R;
  z.R.bottomRightCorner(b.R.rows(), b.R.rows()) = b.R;
  return z;
}

bool inflate_noise_beyond(double gate, const Belief& belief, Observation& z) {
  const double d = squared_mahalanobis(belief, z);
  if (d <= gate) return true;
  z.R *= d / gate;
  return false;
}

}  // namespace curbstone::ekf::model
