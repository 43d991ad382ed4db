#pragma once

#include <vector>

#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::mapper::registration {

/// A feature of the scan and the corresponding shape of the map. Distances are weighted by `weight` (1 / sigma).
struct FeatureMatch {
  Eigen::Vector3d point;  ///< m, base_link
  Eigen::Vector3d mean;   ///< m, map
  Eigen::Vector3d axis;   ///< a plane's normal, a line's direction
  double weight;          ///< 1/m
  bool line;
};

/// The least-squares problem: the matches and the prior.
struct LoamProblem {
  Pose T_map_base;  ///< initial guess
  std::vector<FeatureMatch> matches;
  PosePrior prior;
  double prior_weight = 1;             ///< weight of the prior's squared error relative to one match's
  double kernel = 1.5;                 ///< sigmas: the bound of the Huber kernel
  Matrix6 seen = Matrix6::Identity();  ///< Observability::P: directions that it projects out follow the prior
};

/// Solves for the small change of the pose, by robust least squares with Ceres's small dense solver. One thread;
/// bit-identical on every run. The result is not finite if the problem cannot be solved.
[[nodiscard]] Vector6 solve_loam(const LoamProblem& problem);

}  // namespace curbstone::mapper::registration
