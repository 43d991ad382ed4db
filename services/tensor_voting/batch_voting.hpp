#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "services/tensor_voting/tensor.hpp"
#include "services/tensor_voting/vote_kernel.hpp"
#include "services/tensor_voting/voting_parameters.hpp"

namespace curbstone {

/// A whole cloud at once.

/// Ball votes of points at whole numbers of `step` (m): what each point has received. With a voxel, points that are
/// thinned out take the sums of the first point in their voxel. Every thread count gives the same bits, and so does
/// VotingField. Throws std::invalid_argument on parameters that mean nothing.
[[nodiscard]] std::vector<VoteSums> vote_batch(std::span<const StepPoint> points, double step,
                                               const VotingParameters& parameters, int threads = 1);

/// A cloud of any coordinates, in m, brought into steps fine enough for `sigma` (sigma / 65536 at most) around a local
/// origin, so that coordinates of 1e6 m lose nothing.
struct StepCloud {
  double step = 0;
  std::vector<StepPoint> points;      ///< those that could be used
  std::vector<std::uint32_t> source;  ///< the index of each in the cloud
  std::size_t not_finite = 0;         ///< skipped
  std::size_t too_far = 0;            ///< skipped: more than 2^30 steps from the cloud's median (5 km at sigma 0.3)
};
[[nodiscard]] StepCloud to_steps(std::span<const Eigen::Vector3d> points, double sigma);

/// The tensors of a cloud. Points that were skipped get a tensor without votes.
struct CloudVotes {
  std::vector<Tensor> tensors;  ///< of every point, in the order of the cloud
  std::size_t not_finite = 0;
  std::size_t too_far = 0;
};
[[nodiscard]] CloudVotes vote_cloud(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters,
                                    int threads = 1);

}  // namespace curbstone
