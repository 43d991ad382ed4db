#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::voting {

/// @file
/// The reference in double precision: slow, plain, and what everything faster is compared with.

/// Adds the ball vote of a voter at `offset` (voter to votee or back: the vote is the same), equation (B). No vote at
/// offset zero (a point itself, or a duplicate of it) nor from radius on. Lengths in any one unit.
void add_ball_vote(const Eigen::Vector3d& offset, const VotingParameters& parameters, kernels::Tensor& tensor);

/// The tensors of all points by brute force over all pairs, O(N^2). Points must be finite. `voxel` is not looked at:
/// every point votes.
[[nodiscard]] std::vector<kernels::Tensor> vote_brute_force(std::span<const Eigen::Vector3d> points,
                                                            const VotingParameters& parameters);

}  // namespace curbstone::tensor_voting::voting
