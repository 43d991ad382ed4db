#pragma once

namespace curbstone::tensor_voting::voting {

/// The parameters of a ball vote (reference: tensor voting, equation (B)): a voter at distance d < radius in direction
/// u adds w(d) (I - ball u u^T) with w(d) = exp(-d^2 / sigma^2).
struct VotingParameters {
  double sigma = 0.3;   ///< m, > 0: the scale of the decay
  double radius = 0.9;  ///< m, > 0: votes end before this distance; 3 sigma leaves out 1.2e-4 of a plane's mass
  double ball = 1.0;    ///< a, in [1/2, 1]: 1 "straight continuation" (the paper's), 1/2 the exact cos^2 field
  double voxel = 0.1;   ///< m, >= 0: of all points in a voxel only the first one votes; 0: every point votes

  bool operator==(const VotingParameters&) const = default;
};

/// Throws std::invalid_argument on invalid parameters, with name, value and what was expected.
void validate(const VotingParameters& parameters);

}  // namespace curbstone::tensor_voting::voting
