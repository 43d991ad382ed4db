#include "services/semantic_map/ground/robust_plane.hpp"

#include <Eigen/Dense>

namespace curbstone::semantic_map::ground {

Plane fit_plane(const std::vector<PlaneSample>& samples, const Plane& prior, const PlaneFit& fit) {
  Plane plane = prior;
  const double stiffness = (fit.sample_sigma / fit.slope_sigma) * (fit.sample_sigma / fit.slope_sigma);
  for (int i = 0; i < fit.iterations; ++i) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const PlaneSample& s : samples) {
      const double residual = s.z - plane.at(s.x, s.y);
      const double scaled = residual / (residual > 0 ? fit.scale_above : fit.scale_below);
      const double weight = s.weight / (1 + scaled * scaled);
      const Eigen::Vector3d row(1, s.x, s.y);
      A += weight * row * row.transpose();
      b += weight * s.z * row;
    }
    A(0, 0) += 1e-9;
    b(0) += 1e-9 * plane.height;
    for (int k = 1; k < 3; ++k) {
      A(k, k) += stiffness;
      b(k) += stiffness * prior.slope(k - 1);
    }
    const Eigen::Vector3d solution = A.ldlt().solve(b);
    plane = {solution(0), solution.tail<2>()};
  }
  return plane;
}

}  // namespace curbstone::semantic_map::ground
