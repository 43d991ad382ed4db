#include "services/semantic_map/ground/robust_plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

namespace curbstone::semantic_map::ground {
namespace {

/// docs/method.md, section 10: the samples are weighted by their residuals from the plane before, and the slope is one
/// more measurement. Each round is solved by QR of the rows themselves.
Plane plane_by_definition(const std::vector<PlaneSample>& samples, const Plane& prior, const PlaneFit& fit) {
  const double stiffness = fit.sample_sigma / fit.slope_sigma;
  const auto n = static_cast<Eigen::Index>(samples.size());
  Plane plane = prior;
  for (int round = 0; round < fit.iterations; ++round) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n + 2, 3);
    Eigen::VectorXd right(n + 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      const PlaneSample& s = samples[static_cast<std::size_t>(i)];
      const double residual = s.z - plane.at(s.x, s.y);
      const double c = residual > 0 ? fit.scale_above : fit.scale_below;
      const double root = std::sqrt(s.weight / (1 + residual * residual / (c * c)));
      rows.row(i) << root, root * s.x, root * s.y;
      right(i) = root * s.z;
    }
    rows.bottomRightCorner<2, 2>().diagonal().setConstant(stiffness);
    right.tail<2>() = stiffness * prior.slope;
    const Eigen::Vector3d solution = rows.colPivHouseholderQr().solve(right);
    plane = {solution(0), solution.tail<2>()};
  }
  return plane;
}

/// A road that slopes, and a car on a quarter of it.
std::vector<PlaneSample> road_with_a_car() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  std::normal_distribution<double> noise(0, 0.02);
  std::vector<PlaneSample> samples;
  for (int i = 0; i < 60; ++i) {
    const double x = place(random), y = place(random);
    samples.push_back({x, y, 3 + 0.04 * x - 0.02 * y + noise(random) + (i % 4 == 0 ? 0.4 : 0), 0.5 + 0.1 * (i % 7)});
  }
  return samples;
}

TEST(RobustPlane, IsWhatTheMethodSays) {
  for (const PlaneFit& fit :
       {PlaneFit{.scale_above = 0.2, .scale_below = 0.5, .slope_sigma = 0.10, .sample_sigma = 0.15},
        PlaneFit{.scale_above = 0.05, .scale_below = 0.05, .slope_sigma = 0.05, .sample_sigma = 0.05},
        PlaneFit{.scale_above = 0.05, .scale_below = 0.05, .iterations = 1}}) {
    const Plane prior{3.1, {0.01, 0.02}};
    const Plane plane = fit_plane(road_with_a_car(), prior, fit);
    const Plane expected = plane_by_definition(road_with_a_car(), prior, fit);
    EXPECT_NEAR(plane.height, expected.height, 1e-8);
    EXPECT_LT((plane.slope - expected.slope).norm(), 1e-8);
  }
}

TEST(RobustPlane, OfACarOnItHasTheRoadsHeightAndSlope) {
  const Plane plane = fit_plane(road_with_a_car(), {3, Eigen::Vector2d::Zero()},
                                {.scale_above = 0.05, .scale_below = 0.05, .slope_sigma = 0.05, .sample_sigma = 0.05});
  EXPECT_NEAR(plane.height, 3, 0.02);
  EXPECT_LT((plane.slope - Eigen::Vector2d(0.04, -0.02)).norm(), 0.01);
}

TEST(RobustPlane, KeepsTheSlopeBeforeWhereNoSampleShowsOne) {
  const Plane prior{0, {0.03, -0.07}};
  const Plane plane = fit_plane({{0, 0, 1, 1}, {0, 0, 1.01, 1}}, prior, {});
  EXPECT_NEAR(plane.height, 1.005, 1e-6);
  EXPECT_LT((plane.slope - prior.slope).norm(), 1e-12);
}

}  // namespace
}  // namespace curbstone::semantic_map::ground
