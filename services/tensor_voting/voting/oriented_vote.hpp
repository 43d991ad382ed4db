#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "services/tensor_voting/kernels/decomposition.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::voting {

/// @file
/// The second pass in double precision: the reference for the faster implementations.

/// The vote of all normals in the span of a projector Q of rank m, uniformly, with cos^2 decay: formula (G),
///   V_Q = w(d) R H R,  H = Q - ((u^T Q u) Q + 2 Q u u^T Q) / (m + 2),  R = I - 2 u u^T.
/// m = 1 is a stick, w (1 - (u.e1)^2) (R e1)(R e1)^T; m = 2 a plate; m = 3 a ball, 4/5 w (I - u u^T / 2).
[[nodiscard]] Eigen::Matrix3d projector_vote(const Eigen::Vector3d& offset, const Eigen::Matrix3d& Q, int rank,
                                             double sigma);

/// Adds the vote of a decomposed voter at `offset`: stick V_{e1 e1^T} + plate V_{I - e3 e3^T}, weighted by its shares;
/// the mass grows by w (stick + plate). There is no vote at offset zero nor at `radius` and beyond.
void add_oriented_vote(const Eigen::Vector3d& offset, const kernels::Decomposition& voter,
                       const VotingParameters& parameters, kernels::Tensor& tensor);

/// The second pass by brute force, O(N^2), after vote_brute_force() and decompose().
[[nodiscard]] std::vector<kernels::Tensor> vote_again_brute_force(
    std::span<const Eigen::Vector3d> points, std::span<const kernels::Decomposition> decompositions,
    const VotingParameters& parameters);

}  // namespace curbstone::tensor_voting::voting
