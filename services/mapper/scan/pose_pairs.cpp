#include "services/mapper/scan/pose_pairs.hpp"

#include <Eigen/Geometry>

namespace curbstone::mapper::scan {

void PosePairs::add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
  if (!empty() && utime <= newest()) clear();
  places_.push_back({utime, T_map_base, T_odom_base});
  while (utime - places_.front().utime > kSpan) places_.pop_front();
}

Eigen::Vector3d PosePairs::turned_apart(const Pose& T_map_base, const Pose& T_odom_base) const {
  const Place& before = places_.front();
  const Pose by_map = before.T_map_base.inverse() * T_map_base;
  const Pose by_odometry = before.T_odom_base.inverse() * T_odom_base;
  return so3_log(Eigen::Quaterniond(by_odometry.linear().transpose() * by_map.linear()));
}

Pose PosePairs::by_odometry(const Pose& T_odom_base) const {
  const Place& before = places_.front();
  return before.T_map_base * before.T_odom_base.inverse() * T_odom_base;
}

}  // namespace curbstone::mapper::scan
