#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::voting {

/// @file
/// The reference implementation in double precision: slow and simple. The faster implementations are compared with it.

/// Adds the ball vote of a voter at `offset`, equation (B). The vote is the same for an offset from voter to votee and
/// back. There is no vote at offset zero (the point itself, or a duplicate) nor at `radius` and beyond. Lengths in any
/// one unit.
void add_ball_vote(const Eigen::Vector3d& offset, const VotingParameters& parameters, kernels::Tensor& tensor);

/// The tensors of all points by brute force over all pairs, O(N^2). Points must be finite. `voxel` is ignored: every
/// point votes.
[[nodiscard]] std::vector<kernels::Tensor> vote_brute_force(std::span<const Eigen::Vector3d> points,
                                                            const VotingParameters& parameters);

}  // namespace curbstone::tensor_voting::voting
