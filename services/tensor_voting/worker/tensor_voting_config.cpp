#include "services/tensor_voting/worker/tensor_voting_config.hpp"

#include <stdexcept>

namespace curbstone::tensor_voting::worker {

std::vector<voting::VotingParameters> TensorVotingConfig::scales() const {
  if (sigma.empty() || sigma.size() > 8 || sigma.size() != voxel.size()) {
    throw std::invalid_argument("tensor_voting: sigma and voxel must be lists of the same length, 1 to 8 scales");
  }
  std::vector<voting::VotingParameters> result;
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    result.push_back({.sigma = sigma[i], .radius = radius * sigma[i], .ball = ball, .voxel = voxel[i]});
  }
  return result;
}

}  // namespace curbstone::tensor_voting::worker
