#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace curbstone::semantic_map::ground {

/// z = height + slope . (x, y): a plane about a point of reference.
struct Plane {
  double height = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  [[nodiscard]] double at(double x, double y) const { return height + slope.x() * x + slope.y() * y; }
  bool operator==(const Plane&) const = default;
};

struct PlaneSample {
  double x = 0, y = 0, z = 0;
  double weight = 1;
};

struct PlaneFit {
  double scale_above = 0.05;  ///< m: larger residuals are down-weighted (Cauchy weights)
  double scale_below = 0.05;
  double slope_sigma = 0.1;  ///< standard deviation of the slope about `prior`, against `sample_sigma` of one sample
  double sample_sigma = 0.05;
  int iterations = 8;
};

/// Iteratively reweighted least squares from `prior`. The same result whatever the order of magnitude of the weights.
[[nodiscard]] Plane fit_plane(const std::vector<PlaneSample>& samples, const Plane& prior, const PlaneFit& fit);

}  // namespace curbstone::semantic_map::ground
