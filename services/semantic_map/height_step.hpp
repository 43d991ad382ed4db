#pragma once

#include <optional>
#include <vector>

#include "services/semantic_map/curb_parameters.hpp"

namespace curbstone {

/// A point in the frame of a suspected step: u across it, towards the higher side, t along it, z up; m.
struct StepPointUTZ {
  double u = 0, t = 0, z = 0;
  bool is_ground = true;  ///< may carry a side; the others only say where the riser stands
};

/// Two parallel half-planes, low for u < at and high beyond, with one slope that both share (so that camber, ramps and
/// hills are no steps), fitted to the points.
struct HeightStep {
  double at = 0;         ///< m in u: where the step is
  double height = 0;     ///< m
  double sigma = 0;      ///< m, of `height`, from the residual noise of the data
  double roughness = 0;  ///< m, residual RMS of the points about their half-planes
  double low_z = 0;      ///< m, of the low side at (at, t = 0)
  double clear = 0;      ///< m between the low side's upper fifth and the high side's lower fifth, slope removed
  double foot = 0;       ///< m in u: where the low side ends
  int face_above = 0;    ///< points that stand on the step and go on above it: a wall's
};

/// Finds the step that explains the points best. `noise` m is what heights are known to scatter by around. Nothing
/// where a side is too thin to say.
[[nodiscard]] std::optional<HeightStep> find_height_step(const std::vector<StepPointUTZ>& points, double noise,
                                                         const CurbParameters& parameters);

}  // namespace curbstone
