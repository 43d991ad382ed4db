#pragma once

#include <cstdint>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <deque>
#include <unordered_map>
#include <vector>

#include "common/bus/node.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "services/mapper/dense_map/dense_map.hpp"
#include "services/mapper/dense_map/unreadable_tiles.hpp"
#include "services/mapper/drive_log.hpp"
#include "services/mapper/send_queue.hpp"
#include "services/mapper/trajectory.hpp"

namespace curbstone::mapper {

/// Publishes the dense map: MAP_POINTS as tiles grow, TILE_INDEX, and the tiles that TILE_REQUESTs ask for. With a new
/// epoch it also publishes the drive so far as MAP_TRAJECTORY, and later again the pages that a subscriber lacks. The
/// rate is bounded; the content of the map does not depend on it. A tile that the file of far tiles does not return is
/// tried again later (UnreadableTiles). One thread; the dense map must not change during a call.
class MapSender {
 public:
  explicit MapSender(Publisher& bus) : bus_(bus) {}

  /// Begins an epoch with the vehicle at `position` (map, m). Everything sent in the previous one is void: the drive so
  /// far is sent again, and so are all tiles, which the caller queues.
  void start_epoch(std::int32_t epoch, const Eigen::Vector3d& position, const std::vector<TrajectoryPoint>& drive);
  /// Queues tiles that have grown, or that are new in this epoch, the nearest first. The next index announces all of
  /// them, so that listeners accept them far from the vehicle, too.
  void queue_tiles(std::vector<TileKey> tiles);
  /// Drops tiles that the map has evicted.
  void forget(const std::vector<TileKey>& tiles);
  void request(const tile_request_t& message) {
    catalog_.request(message);
    drive_.request(message);
  }
  /// Records a pose that was published as MAP_POSE. A pose with LOST is a guess and does not belong to the drive.
  void add_pose(const TrajectoryPoint& point) { drive_.add(point); }

  /// Sends new records, as many as the rate allows for the time since the last call, a quarter of a second at most.
  /// `now`: us.
  void send_changes(const dense_map::DenseMap& map, std::int64_t now);
  /// Sends the next page of the drive, if the drive is being sent again.
  void send_trajectory();
  /// Sends requested tiles, as many as the rate allows for the time that the last send_changes() covered, and one
  /// requested page of the drive.
  void send_requested(const dense_map::DenseMap& map);
  /// Sends TILE_INDEX. `now`: us. `position`: of the vehicle, m in map.
  void send_index(std::int64_t now, const Eigen::Vector3d& position);
  /// How many tiles and pages are queued or requested.
  [[nodiscard]] std::size_t num_outstanding() const {
    return changed_.size() + trajectory_.size() + catalog_.num_requested();
  }
  /// Sends all that is queued.
  void finish(const dense_map::DenseMap& map);

 private:
  /// Sends the records `first` to `last` of a tile, at most one message. Returns the index after the last record sent.
  std::int32_t send_records(TileKey key, const dense_map::DenseTile& tile, const dense_map::TileRecords& content,
                            std::int32_t first, std::int32_t last);

  Publisher& bus_;
  TileCatalog catalog_{"mapper", "MAP_POINTS"};
  std::int32_t epoch_ = 0;
  std::int64_t sent_at_ = 0;                                     // us
  int periods_ = 1;                                              // periods kPeriod that the last send_changes() covered
  std::unordered_map<TileKey, std::int32_t, TileKeyHash> sent_;  // records sent
  SendQueue changed_;
  dense_map::UnreadableTiles unreadable_;
  std::deque<map_trajectory_t> trajectory_;  // pages to send
  DriveLog drive_;
};

}  // namespace curbstone::mapper
