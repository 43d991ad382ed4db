#pragma once

#include <Eigen/Core>
#include <span>

#include "services/tensor_voting/cuda/cuda_backend.hpp"
#include "services/tensor_voting/voting/batch_voting.hpp"

namespace curbstone::tensor_voting::cuda {

/// Converts arguments of CudaBatchVoter to the back end's request. Throws std::invalid_argument on invalid parameters.
[[nodiscard]] BatchRequest request_for(std::span<const Eigen::Vector3d> points,
                                       const voting::VotingParameters& parameters, const voting::BatchOptions& options);
/// Moves the results to `votes`; `output` gets the memory of `votes` in return.
void move_result(BatchOutput& output, voting::CloudVotes& votes);

}  // namespace curbstone::tensor_voting::cuda
