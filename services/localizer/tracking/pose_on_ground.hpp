#pragma once

#include "common/geometry/geometry.hpp"
#include "services/localizer/fields/saved_map.hpp"

namespace curbstone::localizer::tracking {

/// T_map_base of a vehicle of which only `x`, `y`, m, and `yaw`, rad, in map are known: on the map's ground (where it
/// shows none there, at the level about it; else at 0), leaning as `R_odom_base` does, for odom is level.
[[nodiscard]] Pose pose_on_ground(double x, double y, double yaw, const Eigen::Matrix3d& R_odom_base,
                                  fields::SavedMap& map);

}  // namespace curbstone::localizer::tracking
