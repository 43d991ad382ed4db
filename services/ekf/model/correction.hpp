#pragma once

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::model {

/// A measurement of one to six rows compared with what the filter expected:
/// residual = measured - expected = H error + noise(0, R). Made of zeros; allocates nothing.
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

/// Squared Mahalanobis distance of the residual: chi-square with as many degrees of freedom as rows if the filter is
/// honest.
[[nodiscard]] double distance(const Belief& belief, const Observation& z);

/// The gain that is optimal for every component of the error.
[[nodiscard]] Gain optimal_gain(const Belief& belief, const Observation& z);

/// The gain that is optimal but for the position, which moves only by what the gyro's bias about the vertical has led
/// it astray: that is geometry, and large after a start on the move. What scale, axle and course would move it by rests
/// on models of tyres and springs, and made a recorded car's path worse.
[[nodiscard]] Gain guarded_gain(const Belief& belief, const Observation& z);

/// Kalman update by any gain. Joseph's form holds for all of them, and keeps the covariance positive where the short
/// form rounds it away.
void correct(Belief& belief, const Observation& z, const Gain& K);

/// Two independent observations as one of at most kMaxRows: applied together they share the same linearisation.
[[nodiscard]] Observation stack(const Observation& a, const Observation& b);

/// A gate that cannot lock the filter out: an observation farther off than `gate` keeps its direction and loses its
/// weight, the more so the farther it is. Says whether it lay inside.
[[nodiscard]] bool soften_beyond(double gate, const Belief& belief, Observation& z);

/// Chi-square quantiles at 99.9 %, for 1, 3 and 6 degrees of freedom.
inline constexpr double kGate1 = 10.83;
inline constexpr double kGate3 = 16.27;
inline constexpr double kGate6 = 22.46;

}  // namespace curbstone::ekf::model
