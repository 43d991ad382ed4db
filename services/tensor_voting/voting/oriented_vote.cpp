#include "services/tensor_voting/voting/oriented_vote.hpp"

#include <cmath>

namespace curbstone::tensor_voting::voting {

Eigen::Matrix3d projector_vote(const Eigen::Vector3d& offset, const Eigen::Matrix3d& Q, int rank, double sigma) {
  const Eigen::Vector3d u = offset.normalized();
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity() - 2 * u * u.transpose();
  const Eigen::Vector3d Qu = Q * u;
  const Eigen::Matrix3d H = Q - (u.dot(Qu) * Q + 2 * Qu * Qu.transpose()) / (rank + 2);
  return std::exp(-offset.squaredNorm() / (sigma * sigma)) * R * H * R;
}

void add_oriented_vote(const Eigen::Vector3d& offset, const kernels::Decomposition& voter, const VotingParameters& p,
                       kernels::Tensor& tensor) {
  const double d2 = offset.squaredNorm();
  if (!(d2 > 0 && d2 < p.radius * p.radius)) return;
  const Eigen::Matrix3d stick = voter.normal * voter.normal.transpose();
  const Eigen::Matrix3d plate = Eigen::Matrix3d::Identity() - voter.tangent * voter.tangent.transpose();
  const Eigen::Matrix3d vote =
      voter.stick * projector_vote(offset, stick, 1, p.sigma) + voter.plate * projector_vote(offset, plate, 2, p.sigma);
  tensor.xx += vote(0, 0);
  tensor.xy += vote(0, 1);
  tensor.xz += vote(0, 2);
  tensor.yy += vote(1, 1);
  tensor.yz += vote(1, 2);
  tensor.zz += vote(2, 2);
  tensor.mass += std::exp(-d2 / (p.sigma * p.sigma)) * (voter.stick + voter.plate);
}

std::vector<kernels::Tensor> vote_again_brute_force(std::span<const Eigen::Vector3d> points,
                                                    std::span<const kernels::Decomposition> decompositions,
                                                    const VotingParameters& parameters) {
  validate(parameters);
  std::vector<kernels::Tensor> tensors(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      add_oriented_vote(points[i] - points[j], decompositions[j], parameters, tensors[i]);
    }
  }
  return tensors;
}

}  // namespace curbstone::tensor_voting::voting
