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
#include "common/tile_sync/lost_pause.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "services/tensor_voting/worker/publish_schedule.hpp"
#include "services/tensor_voting/worker/rendezvous_owners.hpp"
#include "services/tensor_voting/worker/tensor_voting_config.hpp"
#include "services/tensor_voting/worker/voted_map.hpp"
#include "services/tensor_voting/worker/voted_pages.hpp"

namespace curbstone::tensor_voting::worker {

/// A worker that votes: MAP_POINTS in, VOTED_POINTS of the tiles that it owns out. Any number of workers share the
/// tiles.
///
/// Every worker hears and keeps all map points, so that it can take over at once; it votes only on the tiles that it
/// owns and on their neighbours, whose points are voters for them. What a tile's last revision says is a function of
/// the map points alone. So is a revision's number: the tile's points plus the votes that they have received. It grows
/// with every change, two workers with the same map points give it the same number, and since each part of that sum
/// only grows, nobody reaches the final number without the final content.
///
/// What it has published before it publishes as steps from there. Whoever missed one asks, and gets the whole tile; so
/// does everybody who had the tile from another worker. Those steps are a matter of the way, too: where they lead to is
/// the revision.
///
/// A worker that comes to others listens until it has what is near the vehicle, and only then says that it lives: so
/// nobody lets go of a tile for a worker that does not know it yet.
class TensorVotingNode final : public Node {
 public:
  /// `worker` is this worker's name on the bus. Throws std::invalid_argument on scales that cannot be voted.
  TensorVotingNode(const TensorVotingConfig& config, std::string worker, Publisher& publisher);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  void caught_up(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

 private:
  static constexpr double kRim =
      2 * kTileSize;  ///< m, of keep_radius: tiles there may lack neighbours that were let go
  void on(const map_points_t& message);
  void on(const map_pose_t& message);
  void on(const tile_index_t& message);
  void on(const tile_request_t& message);

  [[nodiscard]] bool follow_epoch(std::int32_t epoch, EpochFollower::Source source);
  void start_epoch(std::int32_t epoch);
  [[nodiscard]] double distance(TileKey key) const;  // from the vehicle, m
  [[nodiscard]] bool owns(TileKey key) const;
  /// Whether a tile's points matter to a tile that we own.
  [[nodiscard]] bool votes_here(TileKey key) const;
  [[nodiscard]] bool publishes(TileKey key) const;
  [[nodiscard]] bool is_near(TileKey key) const { return distance(key) <= config_.keep_radius; }
  /// Far from the vehicle, and yet of use: nobody has published it, or a tile about it, of which there are points. So
  /// it is with most of a drive that begins anew in another epoch.
  [[nodiscard]] bool is_unpublished(TileKey key) const;
  /// A far tile has what it is voted with: of the tiles about it that somebody has published none was let go.
  [[nodiscard]] bool has_neighbours(TileKey key) const;
  [[nodiscard]] bool may_let_go(TileKey key) const;

  void advance(std::int64_t now);
  void review(TileKey key);
  [[nodiscard]] bool may_join() const;
  void reassign();
  void collect_changes();
  void forget_sums(TileKey key);
  void follow_vehicle();
  void announce();
  void publish_paced();
  void publish_all();
  void queue_pages(TileKey key);
  void send_next_page();

  TensorVotingConfig config_;
  std::string worker_;
  Publisher& publisher_;
  VotedMap map_;  // votes on the tiles for which votes_here()
  RendezvousOwners workers_;
  TileFollower follower_;
  TileCatalog catalog_;
  PublishSchedule schedule_;
  std::deque<voted_points_t> pages_;                                  // of the tile that is being sent
  std::unordered_map<TileKey, VotedBase, TileKeyHash> bases_;         // of what is out, from us
  std::unordered_map<TileKey, std::int64_t, TileKeyHash> far_heard_;  // of far tiles: us, when points came last
  std::int64_t chain_ = 0;

  EpochFollower epochs_;
  LostPause pause_{4'000'000};
  std::int32_t epoch_ = 0;  // the present one, once there is one
  double x_ = 0;            // the vehicle, m in map
  double y_ = 0;
  std::int64_t now_ = 0;
  std::int64_t first_tick_ = 0;
  bool joined_ = false;                      // the others may know of us
  std::optional<std::int64_t> index_heard_;  // us: when the mapper's first whole index of this epoch was made
  std::int64_t last_index_ = 0;
  std::int64_t last_request_ = 0;
  std::int64_t mapper_heard_ = 0;
  double budget_ = 0;  // bytes that may be sent

  Counters counters_;
  LatencyWindow latency_;
};

}  // namespace curbstone::tensor_voting::worker
