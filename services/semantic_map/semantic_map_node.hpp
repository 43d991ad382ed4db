#pragma once

#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/bus/node.hpp"
#include "common/shell/latency.hpp"
#include "common/tile_sync/drive_follower.hpp"
#include "common/tile_sync/epoch_follower.hpp"
#include "common/tile_sync/lost_timer.hpp"
#include "common/tile_sync/pose_order.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "services/semantic_map/map_lines.hpp"
#include "services/semantic_map/map_linker.hpp"
#include "services/semantic_map/nearby_curbs.hpp"
#include "services/semantic_map/nearby_markings.hpp"
#include "services/semantic_map/pending_trajectory.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "services/semantic_map/pipeline/update_schedule.hpp"
#include "services/semantic_map/semantic_map_config.hpp"
#include "services/semantic_map/store/map_keeper.hpp"
#include "services/semantic_map/tile/driven_path.hpp"
#include "services/semantic_map/tile/voted_tile_assembler.hpp"

namespace curbstone::semantic_map {

/// VOTED_POINTS in, SEMANTIC_TILE and CURBS out; keeps the map file. Follows the workers' tiles (TILE_INDEX,
/// TILE_REQUEST) and owns SEMANTIC_TILE. The final map is a function of the final voted tiles and the poses alone.
class SemanticMapNode final : public Node {
 public:
  /// Throws MapStoreError if the map file cannot be used; with kWaits only if it is a WrongMapFile, and the rest
  /// is a fault while it lasts.
  SemanticMapNode(const SemanticMapConfig& config, Publisher& bus,
                  store::UnusableFile unusable = store::UnusableFile::kThrows);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  void caught_up(std::int64_t now) override;
  bool idle(std::int64_t now) override;
  [[nodiscard]] std::size_t num_outstanding() const override { return voted_.behind() + drive_.behind(); }
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  void on(voted_points_t message);
  void on(const tile_index_t& message);
  void on(const tile_request_t& message);
  void on(const map_pose_t& message);
  void on(const map_trajectory_t& message);

 private:
  struct Published {
    std::shared_ptr<const tile::MapTile> tile;
    std::int32_t revision = 0;
    std::int64_t at = 0;  // us, time of publication
  };
  /// Whether a message of this epoch belongs to the current epoch, which may begin with it.
  bool follow_epoch(std::int32_t epoch, EpochFollower::Source source);
  template <typename Message>
  bool follow_mapper(const Message& message);
  void enter_epoch(std::int32_t epoch);
  void take(const map_pose_t& message);
  void take(const map_trajectory_t& message);
  /// Takes poses that were lost and sent again.
  void take_again(const map_trajectory_t& message);
  void begin_drive(std::int64_t utime);
  void add_to_driven(const Pose& T_map_base);
  void add_to_path(std::int64_t utime, const Eigen::Vector2d& place);
  void send_requests(std::int64_t now);
  void request_lost_tiles();
  /// Computes columns and classes of tiles with new points, some at a time, and publishes them.
  void show_new_points(std::int64_t now);
  /// Does so for one tile; false if none waits.
  bool show_next(std::int64_t now);
  /// Does the next piece of work and returns the tiles that changed. Nothing if none is due.
  std::optional<std::set<TileKey>> work_on_one(std::int64_t now);
  std::set<TileKey> work_on_all(std::int64_t now);
  void publish_changed(const std::set<TileKey>& changed, std::int64_t now);
  bool publish_if_due(TileKey key, std::int64_t now);
  void publish_tile(const std::shared_ptr<const tile::MapTile>& tile, std::int64_t now);
  void publish(const Published& published);
  void answer_requests();
  void publish_index(std::int64_t now);
  /// Before the first points there are no curbs or markings to publish, and no stamp for them.
  [[nodiscard]] bool has_points() const { return newest_utime_ > 0; }
  void settle();
  void settle_while_lost();
  void publish_final();
  void publish_curbs(std::int64_t now);
  void publish_markings(std::int64_t now);
  void store(std::int64_t now);
  void store_again();
  void draw_picture(const tile::MapLines& lines);

  SemanticMapConfig config_;
  Publisher& bus_;
  tile::VotedTileAssembler assembler_;
  std::shared_ptr<SpillFile> spill_file_;  // layers of far tiles
  pipeline::TilePipeline pipeline_;
  pipeline::UpdateSchedule schedule_;
  store::MapKeeper keeper_;
  MapLinker linker_;
  NearbyCurbs nearby_curbs_;
  NearbyMarkings nearby_markings_;
  TileFollower voted_{"semantic_map", "VOTED_POINTS"};
  DriveFollower drive_{"semantic_map"};
  TileCatalog catalog_{"semantic_map", "SEMANTIC_TILE"};
  bool idles_ = false;        // idle() is called, so tick() need not work
  std::int64_t now_ = 0;      // us, of the last tick()
  std::set<TileKey> unsent_;  // changed since they were published
  std::unordered_map<TileKey, Published, TileKeyHash> published_;
  std::unordered_map<TileKey, std::int32_t, TileKeyHash> revisions_;  // of voted tiles

  EpochFollower epochs_;
  PendingTrajectory pending_trajectory_;
  std::int32_t epoch_ = 0;  // the current one, if has_epoch_
  bool has_epoch_ = false;
  bool drive_started_ = false;
  /// Of the last MAP_POSE.
  PoseStamp last_pose_;
  LostTimer lost_timer_{LostTimer::kSemanticMap};
  std::int64_t newest_utime_ = 0;  // of any input
  Eigen::Vector2d vehicle_ = Eigen::Vector2d::Zero();
  tile::DrivenPath path_;

  bool curbs_changed_ = false;
  Eigen::Vector2d curbs_from_ = Eigen::Vector2d::Zero();  ///< position of the vehicle at the last CURBS
  std::int64_t last_curbs_ = 0;
  bool markings_changed_ = false;
  Eigen::Vector2d markings_from_ = Eigen::Vector2d::Zero();  ///< position of the vehicle at the last MARKINGS
  std::int64_t last_markings_ = 0;
  std::set<TileKey> unstored_;  // must be stored once more, as the map file was lost
  bool lines_unstored_ = false;
  std::int64_t last_lines_stored_ = 0;
  std::int64_t last_index_ = 0;
  std::int64_t last_write_ = 0;
  std::int64_t last_request_ = 0;
  LatencyWindow latency_;
  Counters counters_;
  std::string picture_fault_;
};

}  // namespace curbstone::semantic_map
