#pragma once

#include <vector>

#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::mapper::registration {

/// A feature and where the map has its like. Distances are weighed by `weight` (1 / sigma).
struct FeatureMatch {
  Eigen::Vector3d point;  ///< m, base_link
  Eigen::Vector3d mean;   ///< m, map
  Eigen::Vector3d axis;   ///< a plane's normal, a line's direction
  double weight;          ///< 1/m
  bool line;
};

/// What the matches and the prior together make of a pose.
struct LoamProblem {
  Pose T_map_base;  ///< to begin with
  std::vector<FeatureMatch> matches;
  PosePrior prior;
  double prior_weight = 1;             ///< of the prior's squared error against one match's
  double kernel = 1.5;                 ///< sigmas: Huber's bound
  Matrix6 seen = Matrix6::Identity();  ///< Observability::P: other directions follow the prior
};

/// The small change of the pose that fits best: robust least squares by Ceres's small
/// dense solver. One thread; the same bits each time. Not finite where nothing can be solved.
[[nodiscard]] Vector6 solve_loam(const LoamProblem& problem);

}  // namespace curbstone::mapper::registration
