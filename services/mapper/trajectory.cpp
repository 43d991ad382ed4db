#include "services/mapper/trajectory.hpp"

#include <algorithm>

namespace curbstone::mapper {
namespace {

constexpr double kContradiction = 0.5;         // m between the poses by map and by odometry,
constexpr double kContradictionDrift = 0.05;   // plus m for each m of odometry: a larger difference is an error
constexpr float kFootprint = 0.03F;            // m between footprints
constexpr std::int64_t kWitness = 30'000'000;  // us for which poses by odometry are kept

}  // namespace

void Trajectory::add(const TrajectoryPoint& point, const pose_graph::Atlas& atlas) {
  const Pose T_node_base = atlas.node(point.node).T_map_base.inverse() * point.T_map_base;
  const Footprint footprint{point.utime, point.revolution, point.node, T_node_base.translation().cast<float>(),
                            Eigen::Quaterniond(T_node_base.linear()).cast<float>()};
  const bool stands = !footprints_.empty() && footprints_.back().node == footprint.node &&
                      (footprints_.back().position - footprint.position).norm() < kFootprint;
  if (!stands) footprints_.push_back(footprint);
  if (!point.T_odom_base) return witnesses_.clear();
  witnesses_.push_back({footprint, *point.T_odom_base});
  while (point.utime - witnesses_.front().footprint.utime > kWitness) witnesses_.pop_front();
}

void Trajectory::roll_back(std::int64_t utime) {
  std::erase_if(footprints_, [&](const Footprint& f) { return f.utime > utime; });
  witnesses_.clear();
}

std::vector<TrajectoryPoint> Trajectory::points(const pose_graph::Atlas& atlas) const {
  std::vector<TrajectoryPoint> points;
  points.reserve(footprints_.size() + 1);
  auto witness = witnesses_.begin();
  for (const Footprint& f : footprints_) {
    while (witness != witnesses_.end() && witness->footprint.utime < f.utime) ++witness;
    const bool is_known = witness != witnesses_.end() && witness->footprint.utime == f.utime;
    points.push_back({f.utime, f.revolution, T_map_of(f, atlas), f.node,
                      is_known ? std::optional(witness->T_odom_base) : std::nullopt});
  }
  if (witnesses_.empty() || witnesses_.front().footprint.utime <= footprints_.back().utime) return points;
  const auto& [f, T_odom_base] = witnesses_.front();
  points.push_back({f.utime, f.revolution, T_map_of(f, atlas), f.node, T_odom_base});
  return points;
}

std::optional<std::int64_t> Trajectory::last_agreement(const Pose& T_map_base, std::int64_t utime,
                                                       const Pose& T_odom_base, const pose_graph::Atlas& atlas) const {
  bool disagreed = false;
  for (auto it = witnesses_.rbegin(); it != witnesses_.rend() && utime - it->footprint.utime < kWitness; ++it) {
    const Pose moved = it->T_odom_base.inverse() * T_odom_base;
    const Pose expected = T_map_of(it->footprint, atlas) * moved;
    const double apart = (expected.translation() - T_map_base.translation()).norm();
    const bool agrees = apart < kContradiction + kContradictionDrift * moved.translation().norm();
    if (agrees) return disagreed ? std::optional(it->footprint.utime) : std::nullopt;
    disagreed = true;
  }
  return std::nullopt;
}

Pose Trajectory::T_map_of(const Footprint& footprint, const pose_graph::Atlas& atlas) {
  Pose T_node_base = Pose::Identity();
  T_node_base.translation() = footprint.position.cast<double>();
  T_node_base.linear() = footprint.attitude.cast<double>().normalized().toRotationMatrix();
  return atlas.node(footprint.node).T_map_base * T_node_base;
}

}  // namespace curbstone::mapper
