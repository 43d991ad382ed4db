#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "services/tensor_voting/voting/step_cloud.hpp"

namespace curbstone::tensor_voting::voting {

/// The points that vote, and for each point the voter whose tensor it takes.
struct Thinning {
  std::vector<std::uint32_t> voters;          ///< index into the cloud's points
  std::vector<std::uint32_t> voter_of_point;  ///< index into voters
};

/// Selects the first point in each cube of a lattice of edge `voxel` (m, at least unit / 64), which has a node at 0, 0,
/// 0 of the cloud's own frame.
[[nodiscard]] Thinning first_in_voxel(const StepCloud& cloud, double voxel);

}  // namespace curbstone::tensor_voting::voting
