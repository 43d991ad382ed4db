#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "common/packing/spill_file.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/dense_map/dense_worker.hpp"
#include "services/mapper/intensity/ring_scale.hpp"
#include "services/mapper/journal/recorded_drive.hpp"
#include "services/mapper/local_map.hpp"
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
#include "services/mapper/vain_search.hpp"

namespace curbstone::mapper {

/// Where the vehicle was at the end of a scan, and what the scan did to the map.
struct MapperUpdate {
  std::int64_t utime = 0;  ///< us, end of the scan
  std::int32_t revolution = 0;
  Pose T_map_base = Pose::Identity();
  Pose T_map_odom = Pose::Identity();             ///< the last known, where odometry is missing
  std::optional<Pose> T_map_base_by_scan;         ///< by registration, though odometry may be believed rather
  registration::RegistrationResult registration;  ///< covariance still in base_link axes; see Tracked
  tracking::Fix fix = tracking::Fix::kTracking;
  bool registered = false;
  bool with_odometry = false;
  bool stationary = false;
  std::int64_t standing_since = 0;  ///< us, when the drive's first standstill began,
  bool has_moved = false;           ///< and whether it is over
  bool rearranged = false;          ///< a loop was closed, or the map rolled back: every tile may be another
  bool start_is_over = false;       ///< so it may be: the first standstill's map gives way to the drive's own
  bool hopeless = false;            ///< lost, and not to be found in this map: another mapper should begin a new one
  scan::SharedPoints points;        ///< the scan's, de-skewed, in base_link; never null
};

/// Where what is far from the vehicle lies: a file of its own in the folder that the configuration names.
[[nodiscard]] std::shared_ptr<SpillFile> file_for_far(const config::MapperConfig& config);

/// The mapper's method: track each scan, relocalise if lost, map what fits. The drive is remembered as a graph of
/// keyframes whose loops are closed, and as the dense map. A function of the sequence of calls alone. Pure; one thread
/// calls. With `threads: 2` the dense map is worked on beside it: see DenseWorker. Whoever asks for that map waits for
/// it first. Two maps may be worked on: that of the first standstill, which is shown, and the drive's: see StartMap.
///
/// Counters: those of Tracker, LoopCloser, RingScale and DenseMap (these when it was last waited for); searches (for
/// where the vehicle is, while lost), searches.found, rolled_back, resumed (a drive that another began), resumed.lost
/// (the same, without odometry from its last pose).
class Mapper {
 public:
  /// `far`: what is far from the vehicle lies there; without a folder in memory, packed. See file_for_far().
  explicit Mapper(const config::MapperConfig& config,
                  const std::shared_ptr<SpillFile>& far = std::make_shared<SpillFile>());

  /// Before the first scan: a map of an earlier drive, which stands fast. The drive begins about at the start
  /// that the configuration gives.
  void load(const storage::SavedMap& map);
  /// Before that: parts of it, which need not be in it.
  void load(const storage::SavedTile& tile);
  void load(scan::Keyframe node);

  /// Before the first scan: the drive of a mapper that died. The next scan goes on with it: in its frame, about where
  /// odometry leads from its last pose; where that is not so the place is sought.
  void resume(journal::RecordedDrive drive);

  /// Takes the next scan; nothing when it cannot be placed in time, or holds too few points and odometry does not lead
  /// on: see Tracker::track(). Such changes nothing.
  [[nodiscard]] std::optional<MapperUpdate> process(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  /// Nobody waits for anything: begins to look for what has left the dense map. Else process() does it first.
  void use_the_pause();
  /// The drive ends: its own map is shown from now on. True if another was, and every tile may be another.
  [[nodiscard]] bool show_drive();
  /// The drive is over: what still waits goes into its map, which is shown. Tiles that have changed since
  /// take_changed().
  [[nodiscard]] std::vector<TileKey> finish();

  /// Waits until the dense map has grown by all scans. What has left may be in it still.
  void wait_grown();
  /// Waits until the dense map is what all scans make of it.
  void wait();
  /// The first standstill, and until the drive's own map is shown.
  [[nodiscard]] bool is_at_start() const { return start_.is_there(); }
  /// Whether the map of the first standstill is shown, which the drive's own is not: see shown().
  [[nodiscard]] bool shows_start() const { return start_.is_shown(); }
  /// What listeners see: grown(), but for the beginning of a drive. After wait_grown(), wait() or finish();
  /// else std::logic_error.
  [[nodiscard]] const dense_map::DenseMap& shown() { return shown_map().grown(); }
  /// The drive's own. After wait_grown(), wait() or finish(); else std::logic_error.
  [[nodiscard]] const dense_map::DenseMap& grown() const { return dense_->grown(); }
  /// After wait() or finish(); else std::logic_error.
  [[nodiscard]] const dense_map::DenseMap& dense() const { return dense_->map(); }
  /// Tiles of grown() that have changed since the last call, so far as they have been waited for; each may be there
  /// more than once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  /// The same of shown(), where that is another map.
  [[nodiscard]] std::vector<TileKey> take_changed_of_start() { return start_.map().take_changed(); }
  /// Tiles that were given up for memory since the last call. After wait_grown().
  [[nodiscard]] std::vector<TileKey> take_evicted() { return dense_->take_evicted(); }

  /// All that outlives the drive, in memory. After wait() or finish(). Throws std::runtime_error if the file does not
  /// give back what is far.
  [[nodiscard]] storage::SavedMap saved(std::int32_t epoch) const;
  /// The same, less what a folder holds already; what is far stays away until it is saved.
  [[nodiscard]] storage::MapSnapshot snapshot(std::int32_t epoch, const storage::MapVersions& on_disk) const;

  [[nodiscard]] bool started() const { return tracker_.started(); }
  /// The next scan is the first of the drive, which no other mapper began.
  [[nodiscard]] bool begins() const { return !started() && !left_off_; }
  [[nodiscard]] tracking::Fix fix() const { return tracker_.fix(); }
  [[nodiscard]] const pose_graph::Atlas& atlas() const { return atlas_; }
  /// What the scale of the dense map's intensities was made of.
  [[nodiscard]] const intensity::RingHistograms& rings() const { return scale_.basis(); }
  /// Voxels of the map that registration keeps; bounded by its window.
  [[nodiscard]] std::size_t registration_size() const { return tracker_.registration_size(); }
  [[nodiscard]] Counters counters() const;
  /// Scans in a row that could not be registered.
  [[nodiscard]] int refused_in_a_row() const { return tracker_.refused_in_a_row(); }
  /// Where odometry does not go where the LiDAR does: see WayCheck.
  void add_faults(std::vector<std::string>& faults) const { tracker_.add_faults(faults); }
  [[nodiscard]] bool turns_otherwise() const { return tracker_.turns_otherwise(); }
  [[nodiscard]] std::int64_t turned_otherwise() const { return tracker_.turned_otherwise(); }
  /// The drive's poses, in order, one each few centimetres; a closed loop moves them. See Trajectory::points().
  [[nodiscard]] std::vector<TrajectoryPoint> trajectory() const { return trajectory_.points(atlas_); }
  /// The same for the journal.
  [[nodiscard]] std::vector<journal::RecordedPose> recorded() const;

 private:
  /// Where a scan was taken that the tracker could not place.
  struct Relocalisation {
    Pose T_map_base;
    registration::Matrix6 covariance;
    bool rolled_back;
  };
  /// Where a scan was taken, as the map has it once the scan is part of it.
  struct Mapped {
    Pose T_map_base;
    bool stands;  ///< where odometry does not say whether it does
    bool rearranged;
    bool start_is_over = false;
  };
  /// A scan that went into the dense map.
  struct Earlier {
    Pose T_map_base;
    std::int64_t utime;
  };
  void take_up(const journal::RecordedPose& last, const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] std::optional<Relocalisation> relocalise(const tracking::Tracked& tracked,
                                                         const std::optional<Pose>& T_odom_base);
  [[nodiscard]] bool is_hopeless(std::int64_t utime, bool is_sought, const std::optional<Pose>& T_odom_base);
  [[nodiscard]] bool roll_back_to_agreement(const Pose& T_map_base, std::int64_t utime,
                                            const std::optional<Pose>& T_odom_base);
  [[nodiscard]] Mapped map(const tracking::Tracked& tracked);
  [[nodiscard]] std::optional<Pose> close_loop(const tracking::Tracked& tracked);
  [[nodiscard]] bool drop_removals();
  void grow(const tracking::Tracked& tracked, const Pose& T_map_base, int anchor,
            std::vector<dense_map::DenseWork::Insertion> earlier);
  void stay_at_start();
  [[nodiscard]] dense_map::DenseWorker& shown_map() { return start_.is_shown() ? start_.map() : *dense_; }
  [[nodiscard]] std::optional<dense_map::DenseWork::Look> look_after(const std::optional<Earlier>& earlier,
                                                                     const Pose& T_map_base, std::int64_t utime) const;

  static constexpr double kLongestStep = 0.3;  // s between scans that tell how the vehicle moved

  config::MapperConfig config_;
  tracking::Tracker tracker_;
  pose_graph::Atlas atlas_;
  LocalMap local_map_;
  pose_graph::LoopCloser closer_;
  pose_graph::Relocalizer relocalizer_;
  std::unique_ptr<dense_map::DenseWorker> dense_;  // never null
  std::int64_t dense_began_ = 0;                   // us, its first scan of this process
  intensity::RingScale scale_;
  StartMap start_;
  Trajectory trajectory_;
  Standstill standstill_;
  std::optional<Earlier> earlier_;                 // unless the map has been rearranged since
  std::optional<journal::RecordedPose> left_off_;  // of the mapper that died, until the first scan
  scan::Twist left_off_twist_;                     // then
  std::int64_t searched_ = 0;                      // us
  VainSearch in_vain_;
  bool is_settled_ = false;       // since the vehicle was lost
  std::vector<TileKey> settled_;  // tiles that this changed, until take_changed()
  Pose T_map_odom_ = Pose::Identity();
  Counters counters_;
};

}  // namespace curbstone::mapper
