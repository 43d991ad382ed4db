#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/counters.hpp"
#include "common/geometry.hpp"
#include "services/mapper/atlas.hpp"
#include "services/mapper/dense_worker.hpp"
#include "services/mapper/loop_closer.hpp"
#include "services/mapper/map_snapshot.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/odometry_history.hpp"
#include "services/mapper/place_finder.hpp"
#include "services/mapper/revolution.hpp"
#include "services/mapper/saved_map.hpp"
#include "services/mapper/tracker.hpp"

namespace curbstone {

/// Where the vehicle was at the end of a revolution, and what the revolution did to the map.
struct MapperUpdate {
  std::int64_t utime = 0;  ///< us, end of the revolution
  std::int32_t revolution = 0;
  Pose T_map_base = Pose::Identity();
  Pose T_map_odom = Pose::Identity();  ///< the last known, where odometry is missing
  RegistrationResult registration;     ///< covariance still in base_link axes
  Fix fix = Fix::kTracking;
  bool registered = false;
  bool with_odometry = false;
  bool stationary = false;
  bool rearranged = false;  ///< a loop was closed, or the map rolled back: every tile may be another
};

/// The mapper's method: track each revolution, remember the drive as a graph of places, close its loops, keep the dense
/// map. A function of the sequence of calls alone. Pure; one thread calls. With `threads: 2` the dense map is worked on
/// beside it, see DenseWorker: whoever asks for it waits.
///
/// Counters: those of Tracker and LoopCloser; searches (for where the vehicle is, while lost), searches.found,
/// rolled_back.
class Mapper {
 public:
  explicit Mapper(const MapperConfig& config);

  /// Before the first revolution: a map of an earlier drive, which stands fast. The drive begins about at the start
  /// that the configuration gives.
  void load(const SavedMap& map);
  /// All that outlives the drive.
  [[nodiscard]] SavedMap saved(std::int32_t epoch) const { return snapshot(epoch, {}).map; }
  /// The same, less what a folder holds already.
  [[nodiscard]] MapSnapshot snapshot(std::int32_t epoch, const MapVersions& on_disk) const;

  /// Takes the next revolution; nothing when it cannot be placed in time or holds too few points that can be
  /// measurements: see Tracker::track(). Such changes nothing.
  [[nodiscard]] std::optional<MapperUpdate> process(const Revolution& revolution, const OdometryHistory& odometry);

  /// Tiles that have changed since the last call; each may be there more than once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  /// Tiles that were given up for memory since the last call.
  [[nodiscard]] std::vector<TileKey> take_evicted() { return dense_.take_evicted(); }
  /// Nobody waits for anything now: begins to look for what has left the dense map. Else process() does it first.
  void use_the_pause() { dense_.look(); }

  /// The drive is over: what still waits goes into the dense map. Tiles that have changed since take_changed().
  [[nodiscard]] std::vector<TileKey> finish();

  [[nodiscard]] bool started() const { return tracker_.started(); }
  [[nodiscard]] Fix fix() const { return tracker_.fix(); }
  [[nodiscard]] const DenseMap& dense() const { return dense_.map(); }
  [[nodiscard]] DenseMap& dense() { return dense_.map(); }
  /// The same as soon as it can be told of: what has left may be in it still.
  [[nodiscard]] const DenseMap& grown() const { return dense_.grown(); }
  [[nodiscard]] const Atlas& atlas() const { return atlas_; }
  /// Voxels of the map that registration keeps; bounded by its window.
  [[nodiscard]] std::size_t registration_size() const { return tracker_.registration_size(); }
  [[nodiscard]] Counters counters() const;
  /// Revolutions in a row that could not be registered.
  [[nodiscard]] int refused_in_a_row() const { return tracker_.refused_in_a_row(); }

  /// A revolution's end, as the map has it now.
  struct TrajectoryPoint {
    std::int64_t utime;  ///< us
    std::int32_t revolution;
    Pose T_map_base;
  };
  /// The drive's poses, in order, one each few centimetres; a closed loop moves them.
  [[nodiscard]] std::vector<TrajectoryPoint> trajectory() const;

 private:
  /// Where the vehicle was, seen from a node: when a loop is closed, it moves with that.
  struct Footprint {
    std::int64_t utime;
    std::int32_t revolution;
    std::int32_t node;
    Eigen::Vector3f position;
    Eigen::Quaternionf attitude;
  };
  /// What odometry said at a footprint.
  struct Witness {
    Footprint footprint;
    Pose T_odom_base;
  };
  void take(Tracked& tracked, MapperUpdate& update);
  void take_first(const Tracked::Earlier& first);
  void recall_surroundings(const Eigen::Vector3d& position);
  void notice_motion(Tracked& tracked);
  void grow(Tracked& tracked, int anchor, MapperUpdate& update);
  [[nodiscard]] std::optional<DenseWork::Look> look_through(const Tracked& tracked);
  [[nodiscard]] bool holds_back(const Tracked& tracked, int anchor);
  void release_held();
  void close_loop(Tracked& tracked, MapperUpdate& update);
  void search(Tracked& tracked, MapperUpdate& update);
  [[nodiscard]] int nearest(const Pose& T_map_base) const;
  [[nodiscard]] Pose T_map_of(const Footprint& footprint) const;
  [[nodiscard]] std::optional<std::int64_t> contradiction(const Pose& T_map_base, std::int64_t utime) const;
  void rebuild_registration(const Pose& T_map_base, int reference);
  void leave_footprint(const MapperUpdate& update);

  MapperConfig config_;
  Tracker tracker_;
  Atlas atlas_;
  LoopCloser closer_;
  PlaceFinder finder_;
  DenseWorker dense_;
  DenseWork work_;                     // to begin
  std::vector<Footprint> footprints_;  // one each few centimetres
  std::deque<Witness> witnesses_;      // of late, all with odometry
  std::optional<Pose> T_odom_base_;    // at the end of this revolution
  std::int64_t searched_ = 0;          // us
  Pose T_map_odom_ = Pose::Identity();
  Pose T_map_moved_ = Pose::Identity();     // when the vehicle was last known to move
  std::int64_t moved_ = 0;                  // us, when that was
  std::int64_t started_ = 0;                // us, the end of the first revolution
  bool has_moved_ = false;                  // since then
  std::vector<DenseWork::Insertion> held_;  // of the first standstill, kept out of the dense map for now
  /// The revolution before, if the map has not been rearranged since.
  struct Earlier {
    Pose T_map_base;
    std::int64_t utime;
  };
  std::optional<Earlier> earlier_;
  Counters counters_;
};

}  // namespace curbstone
