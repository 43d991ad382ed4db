#include "services/tensor_voting/voting/ball_vote.hpp"

#include <cmath>

namespace curbstone::tensor_voting::voting {

void add_ball_vote(const Eigen::Vector3d& offset, const VotingParameters& p, kernels::Tensor& tensor) {
  const double d2 = offset.squaredNorm();
  if (!(d2 > 0 && d2 < p.radius * p.radius)) return;
  const double w = std::exp(-d2 / (p.sigma * p.sigma));
  const Eigen::Vector3d u = offset / std::sqrt(d2);
  tensor.xx += w * (1 - p.ball * u.x() * u.x());
  tensor.yy += w * (1 - p.ball * u.y() * u.y());
  tensor.zz += w * (1 - p.ball * u.z() * u.z());
  tensor.xy -= w * p.ball * u.x() * u.y();
  tensor.xz -= w * p.ball * u.x() * u.z();
  tensor.yz -= w * p.ball * u.y() * u.z();
  tensor.mass += w;
}

std::vector<kernels::Tensor> vote_brute_force(std::span<const Eigen::Vector3d> points,
                                              const VotingParameters& parameters) {
  validate(parameters);
  std::vector<kernels::Tensor> tensors(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) add_ball_vote(points[j] - points[i], parameters, tensors[i]);
  }
  return tensors;
}

}  // namespace curbstone::tensor_voting::voting
