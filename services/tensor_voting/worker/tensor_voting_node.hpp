#pragma once

#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/bus/node.hpp"
#include "common/shell/latency.hpp"
#include "common/tile_sync/epoch_follower.hpp"
#include "common/tile_sync/lost_timer.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "common/time/silence_timer.hpp"
#include "services/tensor_voting/worker/publish_schedule.hpp"
#include "services/tensor_voting/worker/rendezvous_owners.hpp"
#include "services/tensor_voting/worker/tensor_voting_config.hpp"
#include "services/tensor_voting/worker/voted_map.hpp"
#include "services/tensor_voting/worker/voted_pages.hpp"

namespace curbstone::tensor_voting::worker {

/// A voting worker: MAP_POINTS in, VOTED_POINTS of the tiles that it owns out. Any number of workers share the tiles.
///
/// Every worker receives and keeps all map points, so that it can take over at once. It votes only on the tiles that it
/// owns and on their neighbours, whose points are voters for them. The content of a tile's last revision is a function
/// of the map points alone. So is the revision's number: the number of the tile's points plus the number of votes that
/// they have received. It grows with every change, and two workers with the same map points give it the same number.
/// Since each part of that sum only grows, no worker reaches the final number without the final content.
///
/// Further revisions of a tile are published as deltas to the previous one. A subscriber that missed a delta requests
/// the whole tile, and so does one whose copy came from another worker. Only the revision identifies the content; the
/// deltas that led to it may differ between workers.
///
/// A worker that joins others only listens until it has the map near the vehicle, and then sends its first heartbeat:
/// no worker gives up a tile for one that does not know the tile yet.
class TensorVotingNode final : public Node {
 public:
  /// `worker` is this worker's name on the bus. Throws std::invalid_argument on invalid scales.
  TensorVotingNode(const TensorVotingConfig& config, std::string worker, Publisher& publisher);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  void caught_up(std::int64_t now) override;
  void end_drive() override { is_over_ = true; }
  [[nodiscard]] std::size_t num_outstanding() const override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

 private:
  static constexpr double kRim = 2 * kTileSize;  ///< m, of keep_radius: tiles there may lack released neighbours
  void on(const map_points_t& message);
  void on(const map_pose_t& message);
  void on(const tile_index_t& message);
  void on(const tile_request_t& message);

  [[nodiscard]] bool follow_epoch(std::int32_t epoch, EpochFollower::Source source);
  void start_epoch(std::int32_t epoch);
  [[nodiscard]] double distance(TileKey key) const;  // from the vehicle, m
  [[nodiscard]] bool owns(TileKey key) const;
  /// Whether a tile's points are voters for a tile that this worker owns.
  [[nodiscard]] bool votes_here(TileKey key) const;
  [[nodiscard]] bool publishes(TileKey key) const;
  [[nodiscard]] bool is_near(TileKey key) const { return distance(key) <= config_.keep_radius; }
  /// Whether a far tile is still needed: it is unpublished, this worker has points of it, or a neighbour with points is
  /// unpublished. This applies to most of a drive that begins anew in another epoch. False once the schedule has
  /// evicted revisions.
  [[nodiscard]] bool is_unpublished(TileKey key) const;
  /// A far tile has all its voters: no published neighbour of it was released.
  [[nodiscard]] bool has_neighbours(TileKey key) const;
  [[nodiscard]] bool may_release(TileKey key) const;

  void advance(std::int64_t now);
  void review(TileKey key);
  [[nodiscard]] bool may_join() const;
  void reassign();
  void collect_changes();
  void forget_sums(TileKey key);
  void follow_vehicle();
  void mute(TileKey key, std::int32_t version);
  void unmute();
  void announce();
  void publish_paced();
  void publish_all();
  void queue_pages(TileKey key);
  void send_next_page();

  TensorVotingConfig config_;
  std::string worker_;
  Publisher& publisher_;
  VotedMap map_;  // votes on the tiles for which votes_here() is true
  RendezvousOwners workers_;
  TileFollower follower_;
  TileCatalog catalog_;
  PublishSchedule schedule_;
  std::deque<voted_points_t> pages_;                                  // pages of the tile that is being sent
  std::unordered_map<TileKey, VotedBase, TileKeyHash> bases_;         // what this worker has published
  std::unordered_map<TileKey, std::int64_t, TileKeyHash> far_heard_;  // of far tiles: us, arrival of the last points
  std::unordered_map<TileKey, std::int32_t, TileKeyHash> full_;  // whose points beyond max_points are not asked for
  std::int64_t chain_ = 0;

  EpochFollower epochs_;
  LostTimer lost_timer_{LostTimer::kVoters};
  std::int32_t epoch_ = 0;  // the present epoch, once there is one
  double x_ = 0;            // position of the vehicle, m in map
  double y_ = 0;
  std::int64_t now_ = 0;
  bool is_over_ = false;  // the drive is: nothing has to be paced
  std::int64_t first_tick_ = 0;
  bool joined_ = false;                      // this worker sends heartbeats
  std::optional<std::int64_t> index_heard_;  // us: when the mapper made its first whole index of this epoch
  std::int64_t last_index_ = 0;
  std::int64_t last_request_ = 0;
  SilenceTimer mapper_silence_;
  double budget_ = 0;  // bytes that may be sent now

  Counters counters_;
  LatencyWindow latency_;
};

}  // namespace curbstone::tensor_voting::worker
