#pragma once

#include <Eigen/Core>
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

/// Looks for height steps at a place, in windows of several directions and lengths. Of those in about one direction the
/// most certain is kept; that also chooses between a long window, which sees more of a straight curb, and a short one,
/// which a bend fits into. Between directions it does not choose: where scan lines are far apart, a step that is put
/// aslant between two of them can be the more certain one. Who goes on along it tells (pool_along_lines()).
class StepSearch {
 public:
  /// `noise`: m, how far heights scatter around. `window` is scratch memory.
  StepSearch(const NearGroundPoints& points, const Eigen::Vector2d& at, double noise,
             const tile::CurbParameters& parameters, StepWindow& window)
      : points_(points), at_(at), noise_(noise), parameters_(parameters), window_(window) {}

  /// Returns whether many points are around: looking farther would not make it clearer.
  bool look_close(const Eigen::Vector2d& up, double half_length);
  /// Returns how near the best fit comes to a step that is certain, which has 1; 0 where nothing can be fitted, less
  /// where the ground falls.
  double look(const Eigen::Vector2d& up, double half_length) { return look_in(up, half_length, true); }
  [[nodiscard]] const std::vector<FoundStep>& found() const { return found_; }

 private:
  double look_in(const Eigen::Vector2d& up, double half_length, bool exactly);
  const NearGroundPoints& points_;
  Eigen::Vector2d at_;
  double noise_;
  const tile::CurbParameters& parameters_;
  StepWindow& window_;
  std::vector<FoundStep> found_;
};

}  // namespace curbstone::semantic_map::curbs
