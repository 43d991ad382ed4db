#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/semantic_map/curbs/curb_face.hpp"
#include "services/semantic_map/curbs/height_step.hpp"
#include "services/semantic_map/curbs/near_ground_points.hpp"

namespace curbstone::semantic_map::curbs {

/// A step, the direction in which it is one, and how far along it the evidence lies.
struct FoundStep {
  HeightStep step;
  CurbFace face;  ///< its middle along `up` from the place that was asked about
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();
  double half_length = 0;  ///< m
};

/// How much was looked at. The same input gives the same, on any machine.
struct SearchEffort {
  std::size_t points = 0;         ///< that were gathered
  std::size_t windows = 0;        ///< that a step was sought in
  std::size_t window_points = 0;  ///< in all of them together
  bool operator==(const SearchEffort&) const = default;
};

/// Searches height steps at a place, in windows of several directions and lengths. Of the steps in about one direction
/// the most certain is kept; that also chooses between a long window, which sees more of a straight curb, and a short
/// one, which a bend fits into. Steps in different directions are all kept: where scan lines are far apart, an oblique
/// step between two of them can be more certain than the true one. Which is right, the steps along it show
/// (pool_along_line()).
class StepSearch {
 public:
  /// `noise`: m, how far heights scatter around. `window` is scratch memory. `effort` grows by what is looked at.
  StepSearch(const NearGroundPoints& points, const Eigen::Vector2d& at, double noise,
             const tile::CurbParameters& parameters, StepWindow& window, SearchEffort& effort)
      : points_(points), at_(at), noise_(noise), parameters_(parameters), window_(window), effort_(effort) {}

  /// Returns whether many points are around: a longer window would not make it clearer.
  bool fit_nearby(const Eigen::Vector2d& up, double half_length);
  /// Returns the certainty of the best fit: 1 and more is a step; 0 where nothing can be fitted, less where the ground
  /// falls.
  double fit(const Eigen::Vector2d& up, double half_length) { return fit_window(up, half_length, true); }
  [[nodiscard]] const std::vector<FoundStep>& found() const { return found_; }

 private:
  double fit_window(const Eigen::Vector2d& up, double half_length, bool exactly);
  const NearGroundPoints& points_;
  Eigen::Vector2d at_;
  double noise_;
  const tile::CurbParameters& parameters_;
  StepWindow& window_;
  SearchEffort& effort_;
  std::vector<FoundStep> found_;
};

}  // namespace curbstone::semantic_map::curbs
