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
#include "services/mapper/drive_log.hpp"
#include "services/mapper/send_queue.hpp"
#include "services/mapper/trajectory.hpp"

namespace curbstone::mapper {

/// Tells the bus of the dense map: MAP_POINTS as tiles grow, TILE_INDEX, what TILE_REQUESTs ask for, and of a map that
/// was rearranged MAP_TRAJECTORY, the drive anew; parts of the drive that somebody lacks go out again. All at a bounded
/// pace; what the map holds does not depend on it. One thread; the dense map must not change during a call.
class MapSender {
 public:
  explicit MapSender(Publisher& bus) : bus_(bus) {}

  /// Everything of the epoch before is void: all of the map goes out anew, and with it the drive until now.
  void start_epoch(std::int32_t epoch, const dense_map::DenseMap& map, const Eigen::Vector3d& nearest_first,
                   const std::vector<TrajectoryPoint>& drive);
  /// These have grown; they go out in this order, those near the vehicle first.
  void changed(const std::vector<TileKey>& tiles);
  /// The map has given these up.
  void forget(const std::vector<TileKey>& tiles);
  void request(const tile_request_t& message) {
    catalog_.request(message);
    drive_.request(message);
  }
  /// A pose of the drive has gone out as MAP_POSE; one that is LOST is a guess, and none of the drive's.
  void posed(const TrajectoryPoint& point) { drive_.add(point); }

  /// What has grown, as much as may go since the last call, a quarter of a second's at most. `now`: us.
  void send_changes(const dense_map::DenseMap& map, std::int64_t now);
  /// A page of the drive, if it goes out anew.
  void send_trajectory();
  /// Tiles that somebody lacks, as many as the time allows that the last send_changes() covered, and a page of the
  /// drive.
  void send_requested(const dense_map::DenseMap& map);
  /// `position`: of the vehicle, m in map.
  void send_index(std::int64_t now, const Eigen::Vector3d& position);
  /// All that waits.
  void finish(const dense_map::DenseMap& map);

 private:
  /// Sends records of a tile from `first` to `last`, at most one message's worth. Returns the index after the last
  /// sent.
  std::int32_t send_records(TileKey key, const dense_map::DenseTile& tile, const dense_map::TileRecords& content,
                            std::int32_t first, std::int32_t last);

  Publisher& bus_;
  TileCatalog catalog_{"mapper", "MAP_POINTS"};
  std::int32_t epoch_ = 0;
  std::int64_t sent_at_ = 0;                                     // us
  int turns_ = 1;                                                // of kTurn, that the last send_changes() covered
  std::unordered_map<TileKey, std::int32_t, TileKeyHash> sent_;  // records that went out
  SendQueue changed_;
  std::deque<map_trajectory_t> trajectory_;  // pages that will be sent
  DriveLog drive_;
};

}  // namespace curbstone::mapper
