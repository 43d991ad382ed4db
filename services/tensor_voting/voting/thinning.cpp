#include "services/tensor_voting/voting/thinning.hpp"

#include <cmath>

#include "services/tensor_voting/voting/voxel_table.hpp"

namespace curbstone::tensor_voting::voting {

Thinning first_in_voxel(const StepCloud& cloud, double voxel) {
  Thinning result;
  result.voter_of_point.reserve(cloud.points.size());
  VoxelTable voxels;
  // The lattice is that of the cloud's frame; its indices are counted from the cloud's origin so that they stay small.
  const Eigen::Vector3d origin_in_voxels = cloud.origin / voxel;
  const Eigen::Vector3d first = origin_in_voxels.array().floor();
  const Eigen::Vector3d rest = origin_in_voxels - first;
  const double voxels_per_step = cloud.step / voxel;
  // Adds half a step, so that rounding of the product cannot move a coordinate on the lattice below it.
  const auto index = [&](std::int64_t steps, int axis) {
    return static_cast<std::int64_t>(std::floor((static_cast<double>(steps) + 0.5) * voxels_per_step + rest[axis]));
  };
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
    const WidePoint& p = cloud.points[i];
    const auto next = static_cast<std::uint32_t>(result.voters.size());
    const std::uint32_t voter = voxels.find_or_insert(VoxelTable::key(index(p.x, 0), index(p.y, 1), index(p.z, 2)));
    if (voter == next) result.voters.push_back(i);
    result.voter_of_point.push_back(voter);
  }
  return result;
}

}  // namespace curbstone::tensor_voting::voting
