#include "services/mapper/tracking/turn_check.hpp"

#include <cmath>

namespace curbstone::mapper::tracking {

void TurnCheck::add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
  if (!places_.empty() && utime <= places_.back().utime) places_.clear();
  places_.push_back({utime, T_map_base, T_odom_base});
  while (utime - places_.front().utime > kSpan) places_.pop_front();
}

bool TurnCheck::contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const {
  if (gives_up(utime)) return false;
  const Pose apart = by_odometry(T_odom_base).inverse() * T_map_base;
  return std::abs(so3_log(Eigen::Quaterniond(apart.linear())).z()) > kMost;
}

bool TurnCheck::gives_up(std::int64_t utime) const {
  return places_.empty() || utime <= places_.back().utime || utime - places_.back().utime > kPatience;
}

Pose TurnCheck::by_odometry(const Pose& T_odom_base) const {
  const Place& before = places_.front();
  return before.T_map_base * before.T_odom_base.inverse() * T_odom_base;
}

}  // namespace curbstone::mapper::tracking
