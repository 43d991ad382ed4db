#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/simulate/world/ground.hpp"

namespace curbstone::simulate::truth {

/// A point on the foot of a curb.
struct TrueCurbVertex {
  Eigen::Vector3d foot;  ///< m, world
  double height = 0;     ///< m, of the curb
  bool dropped = false;  ///< lowered for a driveway: less than 4 cm
};

/// Curbs lower than this count as lowered.
inline constexpr double kDroppedBelow = 0.04;  // m

/// The feet of all curbs of a ground, line by line, points `spacing` m apart: contours of its distance field.
[[nodiscard]] std::vector<std::vector<TrueCurbVertex>> trace_curbs(const world::Ground& ground, double spacing = 0.08);

}  // namespace curbstone::simulate::truth
