#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "services/mapper/mapper.hpp"

/// @file
/// Mapper: saving and loading the map, recording and resuming the drive.

namespace curbstone::mapper {
namespace {

constexpr double kGuess = 1.0;  // m, least error of a pose predicted from the speed alone

Pose upright(double x, double y, double yaw) {
  Pose T_map_base(Eigen::Translation3d(x, y, 0));
  T_map_base.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  return T_map_base;
}

/// Twist between two poses. Zero if they are more than `longest` s apart: then the vehicle stood.
scan::Twist motion_between(const journal::RecordedPose& a, const journal::RecordedPose& b, double longest) {
  const double dt = scan::seconds(a.utime, b.utime);
  if (!(dt > 0 && dt < longest)) return {};
  return scan::twist_of(a.T_map_base.inverse() * b.T_map_base, dt);
}

/// The tile's records; nothing if they cannot be read from the file of far tiles.
std::optional<dense_map::TileRecords> content_of(journal::RecordedTile tile) {
  if (tile.spilled.empty()) return std::move(tile.content);
  try {
    return tile.spilled.read();
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace

std::shared_ptr<SpillFile> make_spill_file(const config::MapperConfig& config) {
  return std::make_shared<SpillFile>(config.far_folder, static_cast<std::uint64_t>(config.keep_free * 1e9));
}

void Mapper::load(const storage::SavedTile& tile) {
  dense_->load(tile.key, tile.z_origin, tile.utime, tile.points);
}

void Mapper::load(scan::Keyframe node) {
  atlas_.add_known(std::move(node));
}

void Mapper::load(const storage::SavedMap& map) {
  for (const storage::SavedTile& tile : map.tiles) load(tile);
  for (const scan::Keyframe& node : map.nodes) load(node);
  for (const pose_graph::PoseEdge& edge : map.edges) atlas_.add_known(edge);
  scale_.restore(map.rings);
  Pose T_map_start = upright(config_.start_x, config_.start_y, config_.start_yaw);
  const int nearest = atlas_.nearest(T_map_start.translation());
  if (nearest != pose_graph::Atlas::kNone) {
    T_map_start.translation().z() = atlas_.node(nearest).T_map_base.translation().z();
  }
  tracker_.begin_at(T_map_start, config_.start_radius);
}

void Mapper::resume(journal::RecordedDrive drive) {
  resumed_pose_ = drive.poses.back();
  if (drive.poses.size() > 1)
    resumed_twist_ = motion_between(*(drive.poses.end() - 2), *resumed_pose_, kMaxScanInterval);
  resumed_map_ = std::move(drive.local_map);
  scale_.restore(std::move(drive.rings));
  const auto num_known = static_cast<std::size_t>(drive.num_known);
  for (std::size_t i = 0; i < drive.nodes.size(); ++i) {
    journal::RecordedNode& node = drive.nodes[i];
    if (i < num_known)
      atlas_.add_known(std::move(node.kept));
    else
      atlas_.restore(std::move(node.kept), node.driven);
  }
  for (const pose_graph::PoseEdge& edge : drive.edges) atlas_.add_known(edge);
  for (auto& [key, tile] : drive.tiles) {
    const std::int32_t z_origin = tile.z_origin;
    auto content = content_of(std::exchange(tile, {}));  // emptied first, so that its data exists once
    if (content) dense_->restore(key, z_origin, std::move(*content), resumed_pose_->T_map_base.translation());
  }
  for (const journal::RecordedPose& pose : drive.poses) {
    const Pose T_odom_base = pose.T_map_odom.inverse() * pose.T_map_base;
    trajectory_.add({pose.utime, pose.revolution, pose.T_map_base, pose.node,
                     pose.with_odometry ? std::optional(T_odom_base) : std::nullopt},
                    atlas_);
  }
}

/// Takes over the drive of a mapper that died, before the first scan. The vehicle is near the pose that odometry
/// predicts from the last pose; registration checks it. Without that odometry (the filter died too) the last motion is
/// extrapolated if this scan is the next one; otherwise the vehicle is searched for.
void Mapper::resume_at(const journal::RecordedPose& last, const scan::Scan& scan,
                       const scan::OdometryHistory& odometry) {
  const double reach = config_.tracker.max_speed * std::abs(scan::seconds(last.utime, scan.start)) + kGuess;
  const Eigen::Vector3d was_at = last.T_map_base.translation();
  const auto go_on = [&](std::int64_t utime, const Pose& T_map_base, double path) {
    T_map_odom_ = last.T_map_odom;
    tracker_.resume(utime, T_map_base, path, resumed_twist_);
    restore_local_map(T_map_base, last.node);
    standstill_ = Standstill{last.standing_since, last.utime, last.T_map_base, last.has_moved};
  };
  if (last.with_odometry && scan.start > last.utime && odometry.covers(scan.start, scan.end)) {
    const Pose T_map_base = normalised(last.T_map_odom * odometry.at(scan.start));
    const double path = (T_map_base.translation() - was_at).norm();
    if (path < reach) return go_on(scan.start, T_map_base, path);  // else the odom frame is a new one
  }
  const double stride = scan::seconds(last.utime, scan.end);
  if (stride > 0 && stride < kMaxScanInterval) return go_on(last.utime, last.T_map_base, 0);
  Pose T_map_start = upright(was_at.x(), was_at.y(), roll_pitch_yaw(last.T_map_base.linear()).z());
  T_map_start.translation().z() = was_at.z();
  tracker_.begin_at(T_map_start, reach);
}

/// The map that scans are registered to, as the mapper that died had it. Keyframes are all that is left of it where
/// that is not known: one scan a metre, so the poses that follow differ by some mm.
void Mapper::restore_local_map(const Pose& T_map_base, int reference) {
  if (resumed_map_) return local_map_.restore(resumed_map_->levels, T_map_base, reference);
  counters_.add("resumed.by_keyframes");
  local_map_.rebuild(T_map_base, reference);
}

storage::SavedMap Mapper::saved(std::int32_t epoch) const {
  storage::SavedMap map = snapshot(epoch, {}).map;
  for (storage::SavedTile& tile : map.tiles) {
    if (!tile.spilled.empty()) tile.points = std::exchange(tile.spilled, {}).read().points();
  }
  return map;
}

storage::MapSnapshot Mapper::snapshot(std::int32_t epoch, const storage::MapVersions& on_disk) const {
  storage::MapSnapshot snapshot = storage::take_snapshot(dense_->map(), atlas_, config_.dense.voxel, epoch, on_disk);
  snapshot.map.rings = scale_.basis();
  snapshot.versions.rings = scale_.basis().scans;
  return snapshot;
}

std::vector<journal::RecordedPose> Mapper::recorded() const {
  const std::vector<TrajectoryPoint> drive = trajectory();
  std::vector<journal::RecordedPose> poses;
  poses.reserve(drive.size());
  for (const TrajectoryPoint& p : drive) {
    const Pose T_map_odom = p.T_odom_base ? normalised(p.T_map_base * p.T_odom_base->inverse()) : T_map_odom_;
    poses.push_back({p.utime, p.revolution, p.node, p.T_map_base, T_map_odom, p.T_odom_base.has_value(),
                     standstill_.began, standstill_.has_moved});
  }
  return poses;
}

}  // namespace curbstone::mapper
