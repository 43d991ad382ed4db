#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/semantic_map/curbs/curb_face.hpp"
#include "services/semantic_map/curbs/height_step.hpp"
#include "services/semantic_map/curbs/near_ground_points.hpp"

namespace curbstone::semantic_map::curbs {

/// A step with its direction, and with the extent of its evidence along it.
struct FoundStep {
  HeightStep step;
  CurbFace face;  ///< its middle is along `up` from the place of the search
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();
  double half_length = 0;  ///< m
};

/// The amount of work of a search, counted. It depends on the input alone, not on the machine.
struct SearchEffort {
  std::size_t points = 0;         ///< gathered
  std::size_t windows = 0;        ///< in which a step was sought
  std::size_t window_points = 0;  ///< in all windows together
  bool operator==(const SearchEffort&) const = default;
};

/// Searches height steps at a place, in windows of several directions and lengths. Of the steps in about one direction
/// the most certain is kept. This also chooses between a long window, which covers more of a straight curb, and a short
/// one, which fits a bend. Steps in different directions are all kept: where scan lines are far apart, an oblique step
/// between two of them can be more certain than the true one. Which one is right is decided by the steps along it
/// (pool_along_line()).
class StepSearch {
 public:
  /// `noise`: m, scatter of the heights around. `window` is scratch memory. The work done is added to `effort`.
  StepSearch(const NearGroundPoints& points, const Eigen::Vector2d& at, double noise,
             const tile::CurbParameters& parameters, StepWindow& window, SearchEffort& effort)
      : points_(points), at_(at), noise_(noise), parameters_(parameters), window_(window), effort_(effort) {}

  /// Fits a step in a short window. Returns whether it holds so many points that a longer window would show no more.
  bool fit_nearby(const Eigen::Vector2d& up, double half_length);
  /// Fits a step. Returns its certainty: 1 and more is a step; 0 if nothing can be fitted, below 0 if the ground falls.
  double fit(const Eigen::Vector2d& up, double half_length) { return fit_window(up, half_length, Trim::kBothWays); }
  [[nodiscard]] const std::vector<FoundStep>& found() const { return found_; }

 private:
  /// How closely the points are selected by the window's rectangle before they are fitted.
  enum class Trim { kLengthwise, kBothWays };
  double fit_window(const Eigen::Vector2d& up, double half_length, Trim trim);
  void fill_window(const Eigen::Vector2d& up, double half_length, Trim trim);
  const NearGroundPoints& points_;
  Eigen::Vector2d at_;
  double noise_;
  const tile::CurbParameters& parameters_;
  StepWindow& window_;
  SearchEffort& effort_;
  std::vector<FoundStep> found_;
};

}  // namespace curbstone::semantic_map::curbs
