#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "common/packing/spill_file.hpp"
#include "common/tile_sync/lost_timer.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/dense_map/dense_worker.hpp"
#include "services/mapper/failed_search.hpp"
#include "services/mapper/intensity/ring_scale.hpp"
#include "services/mapper/journal/recorded_drive.hpp"
#include "services/mapper/local_map/delayed_result.hpp"
#include "services/mapper/local_map/local_map.hpp"
#include "services/mapper/local_map/solved_loop.hpp"
#include "services/mapper/moving_objects/co_moving_objects.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/pose_graph/loop_closer.hpp"
#include "services/mapper/pose_graph/relocalizer.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/standstill.hpp"
#include "services/mapper/start_map.hpp"
#include "services/mapper/storage/map_snapshot.hpp"
#include "services/mapper/storage/saved_map.hpp"
#include "services/mapper/tracking/tracker.hpp"
#include "services/mapper/trajectory.hpp"

namespace curbstone::mapper {

/// The vehicle's pose at the end of a scan, and what the scan changed in the map.
struct MapperUpdate {
  std::int64_t utime = 0;  ///< us, end of the scan
  std::int32_t revolution = 0;
  Pose T_map_base = Pose::Identity();
  Pose T_map_odom = Pose::Identity();             ///< the last known one while odometry is missing
  std::optional<Pose> T_map_base_by_scan;         ///< by registration, even where odometry's pose is used instead
  registration::RegistrationResult registration;  ///< covariance still in base_link axes; see Tracked
  tracking::Fix fix = tracking::Fix::kTracking;
  bool registered = false;
  bool with_odometry = false;
  bool stationary = false;
  std::int64_t standing_since = 0;  ///< us, begin of the drive's first standstill
  bool has_moved = false;           ///< the first standstill is over
  bool rearranged = false;          ///< a loop was closed, or the map was rolled back: every tile may differ
  bool start_is_over = false;       ///< the drive's own map replaces that of the first standstill: likewise
  bool wants_new_drive = false;     ///< lost, and not found in this map: another mapper should begin a new map
  scan::SharedPoints points;        ///< of the scan, de-skewed, in base_link; never null
};

/// The file for tiles and keyframe scans far from the vehicle, in the folder that the configuration names.
[[nodiscard]] std::shared_ptr<SpillFile> make_spill_file(const config::MapperConfig& config);

/// The mapper's method: tracks each scan, relocalises if lost, and maps scans that fit. The drive is kept as a graph of
/// keyframes with loop closure, and as the dense map. The result depends on the sequence of calls alone. Pure; called
/// from one thread. With `threads: 2` the dense map is updated in a second thread (DenseWorker); wait for it before
/// reading that map. There may be two dense maps: that of the first standstill, which is then shown, and the drive's
/// own (StartMap).
///
/// Counters: those of Tracker, LoopCloser, RingScale and DenseMap (of DenseMap as of the last wait); searches (for a
/// lost vehicle), searches.found, rolled_back, resumed (a drive that another mapper began), resumed.lost (likewise, but
/// without odometry from its last pose), resumed.by_keyframes (likewise, with a local map made of keyframes).
class Mapper {
 public:
  /// `spill_file`: storage for what is far from the vehicle; a SpillFile without a folder keeps it in memory, packed.
  /// See make_spill_file().
  explicit Mapper(const config::MapperConfig& config,
                  const std::shared_ptr<SpillFile>& spill_file = std::make_shared<SpillFile>());

  /// Loads the map of an earlier drive, which stays fixed. Before the first scan. The drive begins near the start pose
  /// of the configuration.
  void load(const storage::SavedMap& map);
  /// Load one tile, or one keyframe, of that map: `map` need not contain them then. Before load(map).
  void load(const storage::SavedTile& tile);
  void load(scan::Keyframe node);

  /// Takes over the drive of a mapper that died. Before the first scan. The next scan continues the drive in the same
  /// map frame, near the pose that odometry predicts from its last pose; if that fails, the vehicle is searched for.
  void resume(journal::RecordedDrive drive);

  /// Processes the next scan. Returns nothing, and leaves the map unchanged, if the scan cannot be placed in time, or
  /// if it has too few points and odometry does not continue the pose: see Tracker::track().
  [[nodiscard]] std::optional<MapperUpdate> process(const scan::Scan& revolution,
                                                    const scan::OdometryHistory& odometry);
  /// Begins free-space removal in the dense map. To be called while no result is awaited; otherwise the next process()
  /// does it first.
  void begin_free_space_removal();
  /// Corrects the drive by a loop that is still being solved, as no scan follows. True if the map is rearranged.
  [[nodiscard]] bool close_last_loop();
  /// Shows the drive's own map from now on, as the drive ends. True if another map was shown: then every tile may
  /// differ.
  [[nodiscard]] bool show_drive();
  /// Ends the drive: everything pending goes into the drive's own map, which is then shown. Returns the tiles that have
  /// changed since take_changed().
  [[nodiscard]] std::vector<TileKey> finish();

  /// Waits until all scans are inserted into the dense map. Free-space removal may still be pending.
  void wait_inserted();
  /// Waits until all work on the dense map is done, including free-space removal.
  void wait();
  /// The map of the first standstill exists: until the drive's own map replaces it.
  [[nodiscard]] bool is_at_start() const { return start_.is_there(); }
  /// The map of the first standstill is shown instead of the drive's own: see shown().
  [[nodiscard]] bool shows_start() const { return start_.is_shown(); }
  /// The map to publish: grown(), or at the beginning of a drive the map of the first standstill. Only after
  /// wait_inserted(), wait() or finish(); else throws std::logic_error.
  [[nodiscard]] const dense_map::DenseMap& shown() { return shown_map().grown(); }
  /// The drive's own map, with all scans inserted. Only after wait_inserted(), wait() or finish(); else throws
  /// std::logic_error.
  [[nodiscard]] const dense_map::DenseMap& grown() const { return dense_->grown(); }
  /// The drive's own map, complete. Only after wait() or finish(); else throws std::logic_error.
  [[nodiscard]] const dense_map::DenseMap& dense() const { return dense_->map(); }
  /// Tiles of grown() that have changed since the last call, as of the last wait; a tile may be listed more than once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  /// The same for the map of the first standstill, if shown() is that map.
  [[nodiscard]] std::vector<TileKey> take_changed_of_start() { return start_.map().take_changed(); }
  /// Tiles that were evicted for lack of memory since the last call. After wait_inserted().
  [[nodiscard]] std::vector<TileKey> take_evicted() { return dense_->take_evicted(); }

  /// The map to save, all of it in memory. After wait() or finish(). Throws std::runtime_error if the file of far tiles
  /// cannot be read back.
  [[nodiscard]] storage::SavedMap saved(std::int32_t epoch) const;
  /// The same without what `on_disk` already holds; far tiles stay in their file until they are saved.
  [[nodiscard]] storage::MapSnapshot snapshot(std::int32_t epoch, const storage::MapVersions& on_disk) const;

  [[nodiscard]] bool started() const { return tracker_.started(); }
  /// The next scan is the first of a new drive, not of one that another mapper began.
  [[nodiscard]] bool is_new_drive() const { return !started() && !resumed_pose_; }
  [[nodiscard]] tracking::Fix fix() const { return tracker_.fix(); }
  [[nodiscard]] const pose_graph::Atlas& atlas() const { return atlas_; }
  /// The histograms that the intensity scale of the dense map was computed from.
  [[nodiscard]] const intensity::RingHistograms& rings() const { return scale_.basis(); }
  /// Number of voxels of the registration map; bounded by its window.
  [[nodiscard]] std::size_t registration_size() const { return tracker_.registration_size(); }
  /// The voxels of that map, for the journal. Valid until the next call of another method.
  [[nodiscard]] std::vector<registration::ShapeLevel*> registration_levels() { return tracker_.registration_levels(); }
  [[nodiscard]] Counters counters() const;
  /// Number of scans in a row that could not be registered.
  [[nodiscard]] int refused_in_a_row() const { return tracker_.refused_in_a_row(); }
  /// Appends the tracker's faults: odometry and LiDAR disagree on the way (OdometryCheck), or scans have too few
  /// points.
  void add_faults(std::vector<std::string>& faults) const {
    tracker_.add_faults(faults);
    co_moving_.add_faults(faults);
  }
  /// See Tracker.
  [[nodiscard]] bool turn_refused() const { return tracker_.turn_refused(); }
  [[nodiscard]] std::int64_t turn_refused_at() const { return tracker_.turn_refused_at(); }
  /// The drive's poses in order of time, one every few centimetres; a closed loop moves them. See
  /// Trajectory::points().
  [[nodiscard]] std::vector<TrajectoryPoint> trajectory() const { return trajectory_.points(atlas_); }
  /// The same poses, as the journal records them.
  [[nodiscard]] std::vector<journal::RecordedPose> recorded() const;

 private:
  /// Pose of a scan that the tracker could not place.
  struct Relocalisation {
    Pose T_map_base;
    registration::Matrix6 covariance;
    bool rolled_back;
  };
  /// Pose of a scan after it became part of the map.
  struct Mapped {
    Pose T_map_base;
    bool stands;  ///< the vehicle stands, by its poses; set only where odometry is missing
    bool rearranged;
    bool start_is_over = false;
  };
  /// The last scan that went into the dense map.
  struct Earlier {
    Pose T_map_base;
    std::int64_t utime;
  };
  void resume_at(const journal::RecordedPose& last, const scan::Scan& scan, const scan::OdometryHistory& odometry);
  void restore_local_map(const Pose& T_map_base, int reference);
  [[nodiscard]] std::optional<Pose> trusted_odometry(const scan::OdometryHistory& odometry, std::int64_t utime) const;
  [[nodiscard]] bool must_search(const tracking::Tracked& tracked) const;
  [[nodiscard]] MapperUpdate update_of(const scan::Scan& scan, const tracking::Tracked& tracked,
                                       const std::optional<Relocalisation>& relocalised,
                                       const std::optional<Mapped>& mapped) const;
  [[nodiscard]] std::optional<Relocalisation> relocalise(const tracking::Tracked& tracked,
                                                         const std::optional<Pose>& T_odom_base);
  void note_failed_search(std::int64_t utime, const std::optional<Pose>& T_odom_base);
  void end_search() { failed_search_ = {}, is_settled_ = false; }
  [[nodiscard]] bool roll_back_to_agreement(const Pose& T_map_base, std::int64_t utime,
                                            const std::optional<Pose>& T_odom_base);
  [[nodiscard]] Mapped map(const tracking::Tracked& tracked);
  [[nodiscard]] std::optional<Pose> close_loop(const tracking::Tracked& tracked);
  [[nodiscard]] std::optional<Pose> correct_drive(local_map::SolvedLoop solved, const Pose& T_map_base);
  [[nodiscard]] bool drop_removals();
  void grow(const tracking::Tracked& tracked, const Pose& T_map_base, int anchor,
            std::vector<dense_map::DenseWork::Insertion> earlier);
  void stay_at_start();
  [[nodiscard]] dense_map::DenseWorker& shown_map() { return start_.is_shown() ? start_.map() : *dense_; }
  [[nodiscard]] std::optional<dense_map::DenseWork::FreeSpaceRemoval> removal_after(
      const std::optional<Earlier>& earlier, const Pose& T_map_base, std::int64_t utime) const;

  static constexpr double kMaxScanInterval = 0.3;  // s between scans from which the motion is computed

  config::MapperConfig config_;
  moving_objects::CoMovingObjects co_moving_;
  tracking::Tracker tracker_;
  pose_graph::Atlas atlas_;
  local_map::LocalMap local_map_;
  pose_graph::LoopCloser closer_;
  local_map::DelayedResult<local_map::SolvedLoop> solving_;
  pose_graph::Relocalizer relocalizer_;
  std::unique_ptr<dense_map::DenseWorker> dense_;  // never null
  std::int64_t dense_began_ = 0;                   // us, end of the first scan that this process inserted; 0: none
  intensity::RingScale scale_;
  StartMap start_;
  Trajectory trajectory_;
  Standstill standstill_;
  std::optional<Earlier> earlier_;                        // nothing if the map has been rearranged since
  std::optional<journal::RecordedPose> resumed_pose_;     // last pose of the mapper that died, until the first scan
  std::optional<journal::RecordedLocalMap> resumed_map_;  // likewise
  scan::Twist resumed_twist_;                             // at that pose
  std::int64_t searched_ = 0;                             // us, end of the scan of the last search
  FailedSearch failed_search_;
  bool is_settled_ = false;       // dense_->finish() was called since the vehicle was lost
  std::vector<TileKey> settled_;  // tiles that this call changed, until take_changed()
  Pose T_map_odom_ = Pose::Identity();
  Counters counters_;
};

}  // namespace curbstone::mapper
