#pragma once

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"
#include "services/ekf/model/estimate.hpp"
#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

/// How far an estimate of a simulated drive is off on the ground.
struct GroundError {
  double metres = 0.0;
  double sigmas = 0.0;  ///< by its covariance
};

/// `start`: the truth's index where odom began.
inline GroundError ground_error(const Drive& drive, std::size_t start, const model::Estimate& estimate) {
  const std::size_t i = std::min(drive.index_of(estimate.utime), drive.truth.size() - 1);
  const Pose truth = drive.T_odom_base(i, start);
  const Eigen::Vector2d error = (estimate.T_odom_base.translation() - truth.translation()).head<2>();
  return {error.norm(), std::sqrt(error.dot(Ldlt<2>(estimate.pose_covariance.topLeftCorner<2, 2>()).solve(error)))};
}

}  // namespace curbstone::ekf
