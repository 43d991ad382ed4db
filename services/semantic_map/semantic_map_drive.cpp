#include <utility>

#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/picture/png_file.hpp"
#include "services/semantic_map/semantic_map_node.hpp"
#include "services/semantic_map/semantic_messages.hpp"

/// @file
/// SemanticMapNode: input of the drive, and the end of the drive.

namespace curbstone::semantic_map {

namespace {

constexpr double kPathSpacing = 0.1;          // m, of the path in the picture
constexpr std::size_t kSteppedAtOnce = 4000;  // steps of tiles: most of a second

}  // namespace

/// Messages are held until it is known whether the mapper has begun another epoch.
template <typename Message>
bool SemanticMapNode::follow_mapper(const Message& message) {
  const bool is_present = follow_epoch(message.epoch, EpochFollower::Source::kMapper);
  const std::size_t dropped = is_present ? pending_trajectory_.clear() : pending_trajectory_.hold(message);
  if (dropped > 0) counters_.add("dropped.other_epoch", static_cast<std::int64_t>(dropped));
  return is_present;
}

void SemanticMapNode::on(const map_pose_t& message) {
  const Pose T_map_base = pose_from_arrays(message.map_base_position, message.map_base_orientation);
  if (!is_finite(T_map_base) || message.utime <= 0) return counters_.add("refused.pose");
  if (follow_mapper(message)) take(message);
}

void SemanticMapNode::take(const map_pose_t& message) {
  const PoseStamp stamp{message.utime, message.revolution};
  if (is_overtaken(stamp, last_pose_)) return counters_.add("dropped.late");
  begin_drive(message.utime);
  last_pose_ = stamp;
  const Pose T_map_base = pose_from_arrays(message.map_base_position, message.map_base_orientation);
  vehicle_ = T_map_base.translation().head<2>();
  const bool is_guess = (message.flags & map_pose_t::LOST) != 0;
  lost_timer_.on_pose(message.utime, is_guess);
  if (is_guess) return;  // a guess is not part of the drive
  if (path_.empty() || (path_.last() - vehicle_).norm() > kPathSpacing) add_to_path(message.utime, vehicle_);
  add_to_driven(T_map_base);
  keeper_.put(tile::TrajectoryPose{message.utime, message.revolution, T_map_base});
  drive_.add(message.utime);
}

/// Takes the drive of a new epoch: earlier poses of MAP_POSE are void.
void SemanticMapNode::on(const map_trajectory_t& message) {
  if (follow_mapper(message)) take(message);
}

void SemanticMapNode::take(const map_trajectory_t& message) {
  if (message.page == kPageAgain) return take_again(message);
  for (std::size_t i = 0; i < message.utimes.size(); ++i) {
    const Pose T_map_base = pose_of(message, i);
    const std::int64_t utime = message.utimes[i];
    if (!is_finite(T_map_base) || utime <= 0) {
      counters_.add("refused.pose");
      continue;
    }
    begin_drive(utime);
    add_to_path(utime, T_map_base.translation().head<2>());
    add_to_driven(T_map_base);
    keeper_.put(tile::TrajectoryPose{utime, message.revolutions[i], T_map_base});
    drive_.add(utime);
  }
  if (message.page == 0 && !message.utimes.empty() && message.utimes.front() > 0)
    keeper_.corrected_from(message.utimes.front());
}

/// Called once the drive has begun: its first pose decides whether the map file has the same drive.
void SemanticMapNode::take_again(const map_trajectory_t& message) {
  for (std::size_t i = 0; drive_started_ && i < message.utimes.size(); ++i) {
    const Pose T_map_base = pose_of(message, i);
    const std::int64_t utime = message.utimes[i];
    if (!is_finite(T_map_base) || utime <= 0) {
      counters_.add("refused.pose");
      continue;
    }
    if (!drive_.add(utime)) continue;
    counters_.add("poses_again");
    add_to_path(utime, T_map_base.translation().head<2>());
    add_to_driven(T_map_base);
    keeper_.put(tile::TrajectoryPose{utime, message.revolutions[i], T_map_base});
  }
}

void SemanticMapNode::add_to_path(std::int64_t utime, const Eigen::Vector2d& place) {
  path_.add(utime, place);
  if (keeper_.keeps()) linker_.add_place(utime, place);
}

void SemanticMapNode::add_to_driven(const Pose& T_map_base) {
  for (const auto& [key, cells] : cells::cells_beneath(T_map_base, config_.vehicle)) pipeline_.add_driven(key, cells);
}

void SemanticMapNode::begin_drive(std::int64_t utime) {
  if (!drive_started_) keeper_.start(epoch_, utime);
  drive_started_ = true;
}

/// Computes and publishes everything that is stale or waits.
void SemanticMapNode::settle() {
  pipeline::WorkResult settled = pipeline_.settle();
  request_lost_tiles();
  unsent_.merge(settled.changed);
  if (settled.markings) markings_changed_ = true;
  schedule_.clear();
  for (const TileKey& key : std::exchange(unsent_, {})) publish_tile(pipeline_.classes(key), newest_utime_);
}

/// The map is stored as it would be at the end of the drive: see LostTimer.
void SemanticMapNode::settle_while_lost() {
  if (!lost_timer_.take() || pipeline_.num_stale() > kSteppedAtOnce) return;
  settle();
  lines_unstored_ = true;
  last_lines_stored_ = 0;
}

void SemanticMapNode::finish() {
  settle();  // lost tiles are no longer sent again, but they are counted
  if (has_points()) publish_final();
  MapLineSources sources = line_sources(pipeline_, path_, config_.markings);
  sources.before = keeper_.previous_lines();
  const tile::MapLines lines = link(sources);
  if (drive_started_) keeper_.finish(lines);
  if (!config_.picture.empty()) draw_picture(lines);
}

/// Depends on the map and on the vehicle's last position, not on earlier messages.
void SemanticMapNode::publish_final() {
  if (curbs_changed_ || curbs_from_ != vehicle_) publish_curbs(newest_utime_);
  if (markings_changed_ || (config_.markings.enabled && markings_from_ != vehicle_)) publish_markings(newest_utime_);
  publish_index(newest_utime_);
}

void SemanticMapNode::draw_picture(const tile::MapLines& lines) {
  picture::MapPicture picture;
  for (const TileKey& key : pipeline_.keys()) {
    const auto it = published_.find(key);
    if (it != published_.end()) picture.tiles.push_back(*it->second.tile);
  }
  picture.curbs = lines.curbs;
  picture.markings = lines.markings;
  picture.path = path_.places();
  try {
    picture::write_png(picture::draw_map(picture, {}), config_.picture);
  } catch (const picture::PictureError& error) {
    counters_.add("faults.picture");
    picture_fault_ = error.what();
  }
}

}  // namespace curbstone::semantic_map
