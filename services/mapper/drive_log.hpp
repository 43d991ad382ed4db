#pragma once

#include <cstdint>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <map>
#include <optional>
#include <vector>

#include "common/tile_sync/drive_pages.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "services/mapper/trajectory.hpp"

namespace curbstone::mapper {

/// Poses of the drive as published in the present epoch, for subscribers that lack some: a process that was stopped,
/// starved or killed for a while has lost the messages that did not fit into its socket buffer. Kept in pages of ten
/// seconds (common/tile_sync/drive_pages.hpp). Pure; one thread.
class DriveLog {
 public:
  static constexpr std::size_t kMaxPages = 8640;  ///< a day; the oldest pages are dropped

  /// Begins an epoch with the poses of the drive so far.
  void start_epoch(std::int32_t epoch, const std::vector<TrajectoryPoint>& drive);
  /// Adds a pose that is published.
  void add(const TrajectoryPoint& point);

  void request(const tile_request_t& message) { catalog_.request(message); }
  /// The next page that a subscriber has requested; nothing if none is outstanding.
  [[nodiscard]] std::optional<map_trajectory_t> take_requested();
  /// Index of all pages, newest first; empty before the first pose.
  [[nodiscard]] std::vector<tile_index_t> make_index(std::int64_t now);

 private:
  struct LoggedPose {
    std::int64_t utime;  // us
    std::int32_t revolution;
    Eigen::Vector3f position;     // of base_link in map, m
    Eigen::Quaternionf attitude;  // base_link to map
  };
  TileCatalog catalog_{"mapper", kDriveChannel};
  std::int32_t epoch_ = 0;
  std::map<TileKey, std::vector<LoggedPose>> pages_;
};

/// Appends a pose of base_link in map to a page. Poses are appended in order of time.
void append_pose(map_trajectory_t& page, std::int64_t utime, std::int32_t revolution, const Eigen::Vector3f& position,
                 const Eigen::Quaternionf& attitude);

}  // namespace curbstone::mapper
