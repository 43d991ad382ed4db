#include "services/mapper/drive_log.hpp"

namespace curbstone::mapper {

void append_pose(map_trajectory_t& page, std::int64_t utime, std::int32_t revolution, const Eigen::Vector3f& position,
                 const Eigen::Quaternionf& attitude) {
  page.utime = utime;
  page.utimes.push_back(utime);
  page.revolutions.push_back(revolution);
  page.positions.push_back({position.x(), position.y(), position.z()});
  page.orientations.push_back({attitude.w(), attitude.x(), attitude.y(), attitude.z()});
  page.num_poses = static_cast<std::int32_t>(page.utimes.size());
}

void DriveLog::start_epoch(std::int32_t epoch, const std::vector<TrajectoryPoint>& drive) {
  epoch_ = epoch;
  pages_.clear();
  catalog_.start_epoch(epoch);
  for (const TrajectoryPoint& point : drive) add(point);
}

void DriveLog::add(const TrajectoryPoint& point) {
  const TileKey key = drive_page(point.utime);
  std::vector<LoggedPose>& page = pages_[key];
  if (page.size() >= kMaxPosesPerPage || (!page.empty() && point.utime <= page.back().utime)) return;
  page.push_back({point.utime, point.revolution, point.T_map_base.translation().cast<float>(),
                  Eigen::Quaterniond(point.T_map_base.linear()).cast<float>()});
  catalog_.set_version(key, static_cast<std::int32_t>(page.size()));
  if (pages_.size() <= kMaxPages) return;
  catalog_.remove(pages_.begin()->first);
  pages_.erase(pages_.begin());
}

std::optional<map_trajectory_t> DriveLog::take_requested() {
  const std::vector<TileCatalog::Wanted> wanted = catalog_.take_requests(1);
  if (wanted.empty()) return std::nullopt;
  map_trajectory_t message{};
  message.epoch = epoch_;
  message.page = kPageAgain;
  for (const LoggedPose& pose : pages_.at(wanted.front().key))
    append_pose(message, pose.utime, pose.revolution, pose.position, pose.attitude);
  return message;
}

std::vector<tile_index_t> DriveLog::make_index(std::int64_t now) {
  if (pages_.empty()) return {};
  return catalog_.make_index(now, (pages_.rbegin()->first.x + 1) * kTileSize, 0);
}

}  // namespace curbstone::mapper
