#include "services/mapper/trajectory.hpp"

#include <algorithm>
#include <utility>

namespace curbstone::mapper {
namespace {

constexpr double kContradiction = 0.5;           // m between the poses by map and by odometry,
constexpr double kContradictionDrift = 0.05;     // plus m for each m of odometry: a larger difference is an error
constexpr float kPoseSpacing = 0.03F;            // m between stored poses
constexpr std::int64_t kPairsKept = 30'000'000;  // us for which poses by odometry are kept

}  // namespace

void Trajectory::add(const TrajectoryPoint& point, const pose_graph::Atlas& atlas) {
  const Pose T_node_base = atlas.node(point.node).T_map_base.inverse() * point.T_map_base;
  const StoredPose pose{point.utime, point.revolution, point.node, T_node_base.translation().cast<float>(),
                        Eigen::Quaterniond(T_node_base.linear()).cast<float>()};
  const bool stands = !stored_poses_.empty() && stored_poses_.back().node == pose.node &&
                      (stored_poses_.back().position - pose.position).norm() < kPoseSpacing;
  if (!stands) stored_poses_.push_back(pose);
  const bool set_back = point.utime < std::exchange(last_utime_, point.utime);
  was_set_back_ = was_set_back_ || set_back;
  if (!point.T_odom_base || set_back) odometry_pairs_.clear();
  if (!point.T_odom_base) return;
  odometry_pairs_.push_back({pose, *point.T_odom_base});
  while (point.utime - odometry_pairs_.front().pose.utime > kPairsKept) odometry_pairs_.pop_front();
}

void Trajectory::roll_back(std::int64_t utime) {
  std::erase_if(stored_poses_, [&](const StoredPose& f) { return f.utime > utime; });
  std::erase_if(odometry_pairs_, [&](const OdometryPair& pair) { return pair.pose.utime > utime; });
}

std::vector<TrajectoryPoint> Trajectory::points(const pose_graph::Atlas& atlas) const {
  std::vector<TrajectoryPoint> points;
  points.reserve(stored_poses_.size() + 1);
  // From the end on: the pairs are of the last poses, and before them the clock may have been set.
  auto pair = odometry_pairs_.rbegin();
  for (auto f = stored_poses_.rbegin(); f != stored_poses_.rend(); ++f) {
    while (pair != odometry_pairs_.rend() && pair->pose.utime > f->utime) ++pair;
    const bool is_known = pair != odometry_pairs_.rend() && pair->pose.utime == f->utime;
    points.push_back({f->utime, f->revolution, T_map_of(*f, atlas), f->node,
                      is_known ? std::optional(pair->T_odom_base) : std::nullopt});
  }
  std::reverse(points.begin(), points.end());
  if (odometry_pairs_.empty() || odometry_pairs_.front().pose.utime <= stored_poses_.back().utime) return points;
  const auto& [f, T_odom_base] = odometry_pairs_.front();
  points.push_back({f.utime, f.revolution, T_map_of(f, atlas), f.node, T_odom_base});
  return points;
}

std::optional<std::int64_t> Trajectory::last_agreement(const Pose& T_map_base, std::int64_t utime,
                                                       const Pose& T_odom_base, const pose_graph::Atlas& atlas) const {
  if (was_set_back_) return std::nullopt;
  bool disagreed = false;
  for (auto it = odometry_pairs_.rbegin(); it != odometry_pairs_.rend() && utime - it->pose.utime < kPairsKept; ++it) {
    const Pose moved = it->T_odom_base.inverse() * T_odom_base;
    const Pose expected = T_map_of(it->pose, atlas) * moved;
    const double apart = (expected.translation() - T_map_base.translation()).norm();
    const bool agrees = apart < kContradiction + kContradictionDrift * moved.translation().norm();
    if (agrees) return disagreed ? std::optional(it->pose.utime) : std::nullopt;
    disagreed = true;
  }
  return std::nullopt;
}

Pose Trajectory::T_map_of(const StoredPose& pose, const pose_graph::Atlas& atlas) {
  Pose T_node_base = Pose::Identity();
  T_node_base.translation() = pose.position.cast<double>();
  T_node_base.linear() = pose.attitude.cast<double>().normalized().toRotationMatrix();
  return atlas.node(pose.node).T_map_base * T_node_base;
}

}  // namespace curbstone::mapper
