#pragma once

#include "common/geometry/geometry.hpp"
#include "services/localizer/fields/saved_map.hpp"

namespace curbstone::localizer::tracking {

/// T_map_base of a vehicle of which only `x`, `y`, m, and `yaw`, rad, in map are known. Its height is that of the map's
/// ground at that place; without ground there, the level around it; else 0. Roll and pitch are those of `R_odom_base`,
/// because odom is level.
[[nodiscard]] Pose pose_on_ground(double x, double y, double yaw, const Eigen::Matrix3d& R_odom_base,
                                  fields::SavedMap& map);

}  // namespace curbstone::localizer::tracking
