#include "services/semantic_map/ground/robust_plane.hpp"

#include <cstddef>

#include "common/linear/decompositions.hpp"

namespace curbstone::semantic_map::ground {

namespace {

/// The weight of each sample for a plane.
void weigh(const std::vector<PlaneSample>& samples, const Plane& plane, const PlaneFit& fit,
           std::vector<double>& weights) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const PlaneSample& s = samples[i];
    const double residual = s.z - plane.at(s.x, s.y);
    const double scaled = residual / (residual > 0 ? fit.scale_above : fit.scale_below);
    weights[i] = s.weight / (1 + scaled * scaled);
  }
}

/// Sums of weighted least squares over rows (1, x, y): the lower half of the matrix, and the right-hand side.
struct PlaneEquations {
  double a00 = 0, a10 = 0, a20 = 0, a11 = 0, a21 = 0, a22 = 0;
  double b0 = 0, b1 = 0, b2 = 0;

  void add(const PlaneSample& s, double weight) {
    const double wx = weight * s.x;
    const double wy = weight * s.y;
    const double wz = weight * s.z;
    a00 += weight;
    a10 += wx;
    a20 += wy;
    a11 += wx * s.x;
    a21 += wy * s.x;
    a22 += wy * s.y;
    b0 += wz;
    b1 += wz * s.x;
    b2 += wz * s.y;
  }
};

}  // namespace

Plane fit_plane(const std::vector<PlaneSample>& samples, const Plane& prior, const PlaneFit& fit) {
  Plane plane = prior;
  const double stiffness = (fit.sample_sigma / fit.slope_sigma) * (fit.sample_sigma / fit.slope_sigma);
  std::vector<double> weights(samples.size());
  for (int i = 0; i < fit.iterations; ++i) {
    weigh(samples, plane, fit, weights);
    PlaneEquations sum;
    for (std::size_t k = 0; k < samples.size(); ++k) sum.add(samples[k], weights[k]);
    Eigen::Matrix3d A;
    A << sum.a00 + 1e-9, sum.a10, sum.a20, sum.a10, sum.a11 + stiffness, sum.a21, sum.a20, sum.a21, sum.a22 + stiffness;
    const Eigen::Vector3d b(sum.b0 + 1e-9 * plane.height, sum.b1 + stiffness * prior.slope(0),
                            sum.b2 + stiffness * prior.slope(1));
    const Eigen::Vector3d solution = Ldlt<3>(A).solve(b);
    plane = {solution(0), solution.tail<2>()};
  }
  return plane;
}

}  // namespace curbstone::semantic_map::ground
