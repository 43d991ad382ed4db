#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace curbstone::semantic_map::ground {

/// z = height + slope . (x, y): a plane; x and y are relative to a reference point.
struct Plane {
  double height = 0;                                ///< m, at that point
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< rise per metre, along x and y
  [[nodiscard]] double at(double x, double y) const { return height + slope.x() * x + slope.y() * y; }
  bool operator==(const Plane&) const = default;
};

/// A measured height, for fit_plane().
struct PlaneSample {
  double x = 0, y = 0, z = 0;  ///< m; x and y from the plane's reference point
  double weight = 1;           ///< 1: its 1 sigma is PlaneFit::sample_sigma
};

/// How fit_plane() weighs samples and prior.
struct PlaneFit {
  double scale_above = 0.05;   ///< m: larger residuals are down-weighted (Cauchy weights)
  double scale_below = 0.05;   ///< m: the same for samples below the plane
  double slope_sigma = 0.1;    ///< 1 sigma of the slope about that of `prior`,
  double sample_sigma = 0.05;  ///< m, 1 sigma of a sample of weight 1
  int iterations = 8;
};

/// Iteratively reweighted least squares that starts from `prior` and takes its slope as one more measurement
/// (docs/method.md, section 10). Without samples the result is `prior`. Pure.
[[nodiscard]] Plane fit_plane(const std::vector<PlaneSample>& samples, const Plane& prior, const PlaneFit& fit);

}  // namespace curbstone::semantic_map::ground
