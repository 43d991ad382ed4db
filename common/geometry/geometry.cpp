#include "common/geometry/geometry.hpp"

#include <cmath>
#include <limits>

namespace curbstone {

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  // sin(a/2)/a, by its series near zero
  const double scale = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), scale * rotation.x(), scale * rotation.y(), scale * rotation.z())
      .normalized();
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double sine = v.norm();
  if (sine < 1e-9) return 2.0 * v;
  return 2.0 * std::atan2(sine, sign * q.w()) / sine * v;
}

Pose interpolate(const Pose& a, const Pose& b, double fraction) {
  const Eigen::Quaterniond qa(a.linear());
  const Eigen::Quaterniond qb(b.linear());
  Pose out;
  out.linear() = qa.slerp(fraction, qb).normalized().toRotationMatrix();
  out.translation() = (1.0 - fraction) * a.translation() + fraction * b.translation();
  out.makeAffine();
  return out;
}

Pose normalised(const Pose& pose) {
  Pose out = pose;
  out.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return out;
}

Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& r) {
  return {std::atan2(r(2, 1), r(2, 2)), std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))),
          std::atan2(r(1, 0), r(0, 0))};
}

Eigen::Matrix3d rotation_from_rpy(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Pose pose_from_arrays(const double position[3], const double orientation[4]) {
  Eigen::Quaterniond q(orientation[0], orientation[1], orientation[2], orientation[3]);
  Pose pose = Pose::Identity();
  const double norm = q.norm();
  if (!(std::abs(norm - 1.0) < 1e-2)) {
    pose.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
    return pose;
  }
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = Eigen::Vector3d(position[0], position[1], position[2]);
  return pose;
}

void pose_to_arrays(const Pose& pose, double position[3], double orientation[4]) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
  for (int i = 0; i < 3; ++i) position[i] = pose.translation()[i];
  orientation[0] = q.w();
  orientation[1] = q.x();
  orientation[2] = q.y();
  orientation[3] = q.z();
}

bool is_finite(const Pose& pose) {
  return pose.matrix().allFinite();
}

}  // namespace curbstone
