#pragma once

#include <Eigen/Geometry>

namespace curbstone {

/// A rigid transform. Variables name their frames: `T_map_base` takes coordinates in base_link to coordinates in map.
using Pose = Eigen::Isometry3d;

/// The matrix of the cross product: skew(v) * w = v x w.
[[nodiscard]] inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Converts a rotation vector (axis times angle, rad) to a unit quaternion, and back. The logarithm is the shortest
/// one: its angle is 0 .. pi.
[[nodiscard]] Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation);
[[nodiscard]] Eigen::Vector3d so3_log(const Eigen::Quaterniond& q);

/// The rotation angle of a motion, rad, 0 .. pi.
[[nodiscard]] inline double angle_of(const Pose& motion) {
  return so3_log(Eigen::Quaterniond(motion.linear())).norm();
}

/// Interpolates linearly in position, spherical-linearly in attitude; `fraction` 0 gives `a`, 1 gives `b`.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// The same pose with its rotation made orthonormal again. Long products of Isometry3d accumulate rounding errors.
[[nodiscard]] Pose normalised(const Pose& pose);

/// Roll, pitch, yaw about the fixed axes X, Y, Z in this order (REP-103), rad.
[[nodiscard]] Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& rotation);
[[nodiscard]] Eigen::Matrix3d rotation_from_rpy(double roll, double pitch, double yaw);

/// The pose of an LCM message: position x y z in m, orientation w x y z. A quaternion that is not finite, or far from
/// unit length, gives a pose of NaN: check with is_finite().
[[nodiscard]] Pose pose_from_arrays(const double position[3], const double orientation[4]);
void pose_to_arrays(const Pose& pose, double position[3], double orientation[4]);
[[nodiscard]] bool is_finite(const Pose& pose);

}  // namespace curbstone
