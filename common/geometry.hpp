#pragma once

#include <Eigen/Geometry>

namespace curbstone {

/// A rigid transform. Variables name their frames: `T_map_base` takes coordinates in base_link to coordinates in map.
using Pose = Eigen::Isometry3d;

[[nodiscard]] inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Rotation vector (rad) to rotation and back; the log is the shortest one.
[[nodiscard]] Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation);
[[nodiscard]] Eigen::Vector3d so3_log(const Eigen::Quaterniond& q);

/// By how much a motion turns, rad, 0 .. pi.
[[nodiscard]] inline double angle_of(const Pose& motion) {
  return so3_log(Eigen::Quaterniond(motion.linear())).norm();
}

/// Linear in position, spherical-linear in attitude; `fraction` 0 gives `a`, 1 gives `b`.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// With the rotation made orthonormal again: chains of products of Isometry3d drift off.
[[nodiscard]] Pose normalised(const Pose& pose);

/// Roll, pitch, yaw about fixed X, Y, Z (REP-103), rad.
[[nodiscard]] Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& rotation);
[[nodiscard]] Eigen::Matrix3d rotation_from_rpy(double roll, double pitch, double yaw);

/// As LCM messages carry poses: position x y z, orientation w x y z. A quaternion that is not finite or far from unit
/// length gives an invalid (NaN) pose: check with is_finite().
[[nodiscard]] Pose pose_from_arrays(const double position[3], const double orientation[4]);
void pose_to_arrays(const Pose& pose, double position[3], double orientation[4]);
[[nodiscard]] bool is_finite(const Pose& pose);

}  // namespace curbstone
