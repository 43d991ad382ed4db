#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "services/semantic_map/tile/curb_parameters.hpp"

namespace curbstone::semantic_map::curbs {

/// Points in the frame of a suspected step: u across it, towards the higher side, t along it, z above the DEM; m.
/// Stored by columns, of which only the first size() entries are valid: a window that is used again does not clear its
/// memory.
struct StepWindow {
  static constexpr double kUnfit = 1e9;
  std::vector<double> u, t, z;
  std::vector<double> unfit;  ///< 0: the point may belong to a side; kUnfit: it only shows where the face is
  double half_length = 1e8;   ///< points with a larger |t| do not count
  std::size_t num_points = 0;

  [[nodiscard]] std::size_t size() const { return num_points; }
  [[nodiscard]] bool has(std::size_t i) const { return std::abs(t[i]) <= half_length; }
  void resize(std::size_t n);
  void add(double at_u, double at_t, double at_z, bool is_ground = true);
};

/// Two parallel half-planes fitted to the points, the low one for u < at and the high one beyond. They share one slope,
/// so that camber, ramps and hills are not taken for steps. In the frame of the StepWindow: heights and slopes are
/// relative to the DEM.
struct HeightStep {
  double at = 0;                                    ///< m in u: where the step is
  double height = 0;                                ///< m, of the fit, whose prior keeps the slope small
  double level = 0;                                 ///< m, difference of the two sides' means: the step without a slope
  double full_height = 0;                           ///< m, `height` without the bias of the prior: up to twice as high
  double sigma = 0;                                 ///< m, of `height`, from the residual noise of the data
  double roughness = 0;                             ///< m, residual RMS of the points about their half-planes
  double low_z = 0;                                 ///< m, height of the low side at (at, t = 0)
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of both sides, in u and t

  /// Whether most of the step exists only because both sides are fitted as falling.
  [[nodiscard]] bool falls() const;
};

/// More evidence of the points around a step.
struct StepSides {
  double clear = 0;    ///< m between the low side's upper fifth and the high side's lower fifth, slope removed
  int face_above = 0;  ///< points above the step's face: it continues upwards, as a wall does
};

/// The most certain step, of all places within 0.18 m of u = 0 (docs/method.md, section 11). `noise`: m, 1 sigma of the
/// scatter of the heights around. Nothing if no place has two sides with enough points. Pure, except for scratch memory
/// that each thread keeps for its next call.
[[nodiscard]] std::optional<HeightStep> find_height_step(const StepWindow& points, double noise,
                                                         const tile::CurbParameters& parameters);
/// Takes as long as find_height_step(), so call it for steps that have passed every other test.
[[nodiscard]] StepSides evaluate_sides(const StepWindow& points, const HeightStep& step,
                                       const tile::CurbParameters& parameters);

}  // namespace curbstone::semantic_map::curbs
