#include "services/tensor_voting/voting/voting_parameters.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace curbstone::tensor_voting::voting {

namespace {

void require(bool holds, const char* name, double value, const char* expected) {
  if (!holds) {
    throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) + ": expected " + expected);
  }
}

}  // namespace

void validate(const VotingParameters& p) {
  require(std::isfinite(p.sigma) && p.sigma > 0, "sigma", p.sigma, "a length > 0, in m");
  require(std::isfinite(p.radius) && p.radius > 0, "radius", p.radius, "a length > 0, in m");
  require(p.ball >= 0.5 && p.ball <= 1, "ball", p.ball, "a coefficient in 0.5 .. 1");
  require(std::isfinite(p.voxel) && p.voxel >= 0, "voxel", p.voxel, "a length >= 0, in m");
}

}  // namespace curbstone::tensor_voting::voting
