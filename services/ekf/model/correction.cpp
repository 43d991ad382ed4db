#include "services/ekf/model/correction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace curbstone::ekf::model {

Observation::Observation(int rows)
    : residual(Residual::Zero(rows)), H(Jacobian::Zero(rows, kErrorSize)), R(Noise::Zero(rows, rows)) {}

double squared_mahalanobis(const Belief& belief, const Observation& z) {
  const Observation::Noise S = z.H * belief.covariance * z.H.transpose() + z.R;
  return z.residual.dot(S.ldlt().solve(z.residual));
}

Gain optimal_gain(const Belief& belief, const Observation& z) {
  const Gain PHt = belief.covariance * z.H.transpose();
  const Observation::Noise S = z.H * PHt + z.R;
  return S.ldlt().solve(PHt.transpose()).transpose();
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
  const ErrorMatrix I_KH = ErrorMatrix::Identity() - K * z.H;
  P = propagated(I_KH, P) + K * z.R * K.transpose();
  P = (0.5 * (P + P.transpose())).eval();
  belief.mean = plus(belief.mean, K * z.residual);
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
