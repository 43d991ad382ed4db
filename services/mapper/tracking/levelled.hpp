#pragma once

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::tracking {

/// Gravity's share of an attitude: roll and pitch, without yaw.
[[nodiscard]] inline Pose levelled(const Pose& T_odom_base) {
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_odom_base.linear());
  Pose T = Pose::Identity();
  T.linear() = rotation_from_rpy(rpy.x(), rpy.y(), 0);
  return T;
}

}  // namespace curbstone::mapper::tracking
