#pragma once

#include <Eigen/Core>
#include <span>

#include "services/tensor_voting/batch_voting.hpp"
#include "services/tensor_voting/cuda/cuda_backend.hpp"

namespace curbstone::cuda {

/// Between vote_cloud_cuda() and the back end. Throws std::invalid_argument on parameters that mean nothing.
[[nodiscard]] BatchRequest request_for(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters,
                                       const BatchOptions& options);
[[nodiscard]] CloudVotes to_cloud_votes(const BatchOutput& output);

}  // namespace curbstone::cuda
