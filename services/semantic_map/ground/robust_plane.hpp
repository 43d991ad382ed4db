#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace curbstone::semantic_map::ground {

/// z = height + slope . (x, y): a plane about a point of reference, from which x and y count.
struct Plane {
  double height = 0;                                ///< m, at that point
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< m up a metre, along x and y
  [[nodiscard]] double at(double x, double y) const { return height + slope.x() * x + slope.y() * y; }
  bool operator==(const Plane&) const = default;
};

struct PlaneSample {
  double x = 0, y = 0, z = 0;  ///< m; x and y from the plane's point of reference
  double weight = 1;           ///< 1: as certain as PlaneFit::sample_sigma says
};

struct PlaneFit {
  double scale_above = 0.05;   ///< m: larger residuals are down-weighted (Cauchy weights)
  double scale_below = 0.05;   ///< m: the same of samples below the plane
  double slope_sigma = 0.1;    ///< 1 sigma of the slope about that of `prior`,
  double sample_sigma = 0.05;  ///< m, against 1 sigma of a sample of weight 1
  int iterations = 8;
};

/// Iteratively reweighted least squares from `prior` (docs/method.md, section 10), whose slope is one more measurement.
/// Without samples the result is `prior`. Pure.
[[nodiscard]] Plane fit_plane(const std::vector<PlaneSample>& samples, const Plane& prior, const PlaneFit& fit);

}  // namespace curbstone::semantic_map::ground
