#include "services/mapper/moving_objects/surround_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::moving_objects {
namespace {

constexpr double kMaxThrough = 12;      // m: nearer than this, some laser meets whatever is taller than kTall
constexpr double kThroughMargin = 0.3;  // m by which the LiDAR must have looked past a place,
constexpr double kThroughShare = 0.03;  // and this share of the range
constexpr float kSameRange = 0.1F;      // m, largest difference of a range that stays the same,
constexpr float kSameShare = 0.02F;     // and this share of it

double yaw_of(const Pose& pose) {
  return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
}

}  // namespace

SurroundView::SurroundView(const scan::Scan& scan, const Mounting& mounting, const scan::OdometryHistory& odometry)
    : utime_(scan.end),
      lidar_(mounting.T_base_lidar.translation().head<2>()),
      T_odom_start_(odometry.at(scan.start)),
      T_odom_end_(odometry.at(scan.end)),
      seconds_(static_cast<float>(scan::seconds(scan.start, scan.end))) {
  const Eigen::Isometry3f T_base_lidar = mounting.T_base_lidar.cast<float>();
  const Eigen::Vector2f lidar = lidar_.cast<float>();
  for (const scan::LidarPoint& point : scan.points) {
    if (!scan::measured(point)) continue;
    const Eigen::Vector3f in_base = T_base_lidar * point.position;
    const Eigen::Vector2f away = in_base.head<2>() - lidar;
    const float range = away.norm();
    if (range < kNear || mounting.own_body.contains(in_base)) continue;
    Return& seen = returns_[wrapped(bin_of(away))];
    if (!seen.observed) seen.time = point.time;
    seen.observed = true;
    const float above = in_base.z() - kSlope * range;
    if (range > kFar || above < kLow || above > kHigh) continue;
    if (seen.any_range == 0 || range < seen.any_range) seen.any_range = range;
    if (above < kTall || (seen.range != 0 && range >= seen.range)) continue;
    seen.range = range;
    seen.time = point.time;
    seen.in_base = in_base.head<2>();
  }
  for (Return& seen : returns_) {
    if (seen.range != 0) seen.in_odom = T_odom_base_at(seen.time) * seen.in_base.cast<double>();
  }
}

int SurroundView::bin_of(const Eigen::Vector2f& from_lidar) {
  const float turn = std::atan2(from_lidar.y(), from_lidar.x()) / (2 * std::numbers::pi_v<float>);
  return static_cast<int>(std::floor(turn * kBins));
}

Eigen::Isometry2d SurroundView::T_odom_base_at(float time) const {
  const double fraction = seconds_ > 0 ? static_cast<double>(std::clamp(time / seconds_, 0.0F, 1.0F)) : 1;
  const Pose pose = interpolate(T_odom_start_, T_odom_end_, fraction);
  Eigen::Isometry2d planar(Eigen::Rotation2Dd(yaw_of(pose)));
  planar.translation() = pose.translation().head<2>();
  return planar;
}

Eigen::Vector2f SurroundView::from_lidar(const Eigen::Vector2d& in_odom, float time) const {
  return (T_odom_base_at(time).inverse() * in_odom - lidar_).cast<float>();
}

bool SurroundView::has_range(int bin, float range, float tolerance) const {
  for (int beside = -1; beside <= 1; ++beside) {
    const float seen = at(bin + beside).range;
    if (seen != 0 && std::abs(seen - range) <= tolerance) return true;
  }
  return false;
}

bool SurroundView::has_same_range(const SurroundView& other, int bin) const {
  const float range = at(bin).range;
  return range != 0 && other.has_range(bin, range, kSameRange + kSameShare * range);
}

bool SurroundView::sees_through(const Eigen::Vector2d& in_odom) const {
  // The LiDAR turns: when it looked there, the vehicle was not where it was in the middle of the scan.
  const int about = bin_of(from_lidar(in_odom, 0.5F * seconds_));
  const Eigen::Vector2f away = from_lidar(in_odom, at(about).time);
  const double range = static_cast<double>(away.norm());
  if (range > kMaxThrough || range < static_cast<double>(kNear)) return false;
  const double beyond = range + kThroughMargin + kThroughShare * range;
  const int bin = bin_of(away);
  for (int beside = -1; beside <= 1; ++beside) {
    const Return& seen = at(bin + beside);
    if (!seen.observed || (seen.any_range != 0 && static_cast<double>(seen.any_range) < beyond)) return false;
  }
  return true;
}

}  // namespace curbstone::mapper::moving_objects
