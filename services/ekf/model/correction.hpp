#pragma once

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::model {

/// A measurement of one to six rows compared with the filter's expectation: residual = measured - expected = H error +
/// noise(0, R). Initialised to zeros; allocates nothing.
struct Observation {
  static constexpr int kMaxRows = 6;
  using Residual = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, kErrorSize, 0, kMaxRows, kErrorSize>;
  using Noise = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;

  explicit Observation(int rows);
  Residual residual;
  Jacobian H;
  Noise R;
};
using Gain = Eigen::Matrix<double, kErrorSize, Eigen::Dynamic, 0, kErrorSize, Observation::kMaxRows>;

/// Squared Mahalanobis distance of the residual. If the filter is consistent it is chi-square distributed with as many
/// degrees of freedom as rows.
[[nodiscard]] double squared_mahalanobis(const Belief& belief, const Observation& z);

/// Gain that is optimal for every component of the error.
[[nodiscard]] Gain optimal_gain(const Belief& belief, const Observation& z);

/// Gain that is optimal except for the position, which moves only by the effect of the gyro's bias about the vertical:
/// this effect is geometry, and large after a start on the move. Corrections of the position by scale, axle and course
/// rest on models of tyres and springs, and degraded the path of a recorded car.
[[nodiscard]] Gain guarded_gain(const Belief& belief, const Observation& z);

/// Kalman update with any gain. Joseph's form holds for every gain, and keeps the covariance positive definite where
/// the short form loses that to rounding.
void correct(Belief& belief, const Observation& z, const Gain& K);

/// Stacks two independent observations into one of at most kMaxRows: applied together they share one linearisation.
[[nodiscard]] Observation stack(const Observation& a, const Observation& b);

/// A gate that cannot lock the filter out: an observation beyond `gate` keeps its direction, but its weight decreases
/// with its distance. Returns whether it is inside the gate.
[[nodiscard]] bool inflate_noise_beyond(double gate, const Belief& belief, Observation& z);

/// Chi-square quantiles at 99.9 %, for 1, 3 and 6 degrees of freedom.
inline constexpr double kGate1 = 10.83;
inline constexpr double kGate3 = 16.27;
inline constexpr double kGate6 = 22.46;

}  // namespace curbstone::ekf::model
