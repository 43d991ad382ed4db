#pragma once

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::tracking {

/// The roll and pitch of a pose as a rotation: yaw and translation are zero.
[[nodiscard]] inline Pose levelled(const Pose& T_odom_base) {
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_odom_base.linear());
  Pose T = Pose::Identity();
  T.linear() = rotation_from_rpy(rpy.x(), rpy.y(), 0);
  return T;
}

}  // namespace curbstone::mapper::tracking
