#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"
#include "services/mapper/config/dense_config.hpp"
#include "services/mapper/dense_map/dense_map.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::dense_map {

/// One scan's work on the dense map.
struct DenseWork {
  struct Insertion {
    scan::SharedPoints points;  ///< de-skewed, in base_link
    Pose T_map_base;
    std::int64_t utime;   ///< us
    std::int32_t anchor;  ///< keyframe of the points that settle with this scan
    bool add_new;         ///< false: hits count only in voxels that are pending already
    std::shared_ptr<const intensity::RingTable> scale = nullptr;  ///< of their intensities: DenseMap::set_scale()
  };
  /// Parameters of free-space removal, which uses the points of the last insertion.
  struct FreeSpaceRemoval {
    scan::Twist motion;         ///< during the scan
    std::vector<bool> present;  ///< by anchor: its points are at their true place
    bool on_known_map = false;  ///< likewise for all points of an earlier drive, together
  };
  std::vector<Insertion> insertions;
  std::optional<FreeSpaceRemoval> removal;
};

/// Updates the dense map in a thread of its own: the pose does not depend on it, and it costs as much as the pose.
/// First the insertions are done. Free-space removal begins with begin_free_space_removal(), or before any other
/// operation on the map. So the map is a function of the calls, with or without a second thread. Calls come from one
/// thread.
///
/// Only the calls that say so wait. The const calls never wait: they throw std::logic_error if what they return is
/// still being worked on.
class DenseWorker {
 public:
  /// `threaded`: in a thread of its own; otherwise the work is done within the wait for it. `spill_file`: as for
  /// DenseMap.
  DenseWorker(const config::DenseConfig& config, const Pose& T_base_lidar, bool threaded,
              std::shared_ptr<SpillFile> spill_file = std::make_shared<SpillFile>());
  ~DenseWorker();
  DenseWorker(const DenseWorker&) = delete;
  DenseWorker& operator=(const DenseWorker&) = delete;

  /// Begins work. Waits for earlier work first.
  void begin(DenseWork work);
  /// Begins the free-space removal of the last work unless it has begun. Waits for the current work only then.
  void begin_free_space_removal();
  /// Waits until the insertions are done. Free-space removal may still be pending.
  void wait_inserted();
  /// Waits until all work is done, including free-space removal.
  void wait();

  /// Moves the map with the next work, before its insertions, or with wait(). All tiles are then changed.
  void move(std::vector<Pose> corrections);
  /// The following call DenseMap's functions of the same name. They wait until all work is done first.
  void load(TileKey key, std::int32_t z_origin, std::int64_t utime, const std::vector<TilePoint>& points);
  void restore(TileKey key, std::int32_t z_origin, TileRecords records, const Eigen::Vector3d& at);
  void roll_back(std::int64_t utime);
  [[nodiscard]] std::vector<TileKey> finish();

  /// The map. To be called after wait(), or after a call that changes the map.
  [[nodiscard]] const DenseMap& map() const;
  /// The map after the insertions. To be called after wait_inserted().
  [[nodiscard]] const DenseMap& grown() const;

  /// DenseMap::num_removals() after the last insertions or other change.
  [[nodiscard]] std::int64_t num_removals() const { return grown_.num_removals; }
  /// DenseMap::is_moving() after the last insertions or other change.
  [[nodiscard]] bool is_moving() const { return grown_.is_moving; }
  /// Counters of the map at the last wait.
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Tiles changed since the last call, by the work that has been waited for; a tile may be listed more than once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  /// Makes take_changed() return all tiles. To be called after wait_inserted().
  void note_all_changed() { changed_ = grown().keys(); }
  /// Tiles that were evicted for memory. To be called after wait_inserted().
  [[nodiscard]] std::vector<TileKey> take_evicted();

 private:
  using Work = std::shared_ptr<const DenseWork>;
  /// State of the map after the insertions.
  struct Grown {
    std::int64_t num_removals = 0;
    bool is_moving = false;
  };
  struct Result {
    std::vector<TileKey> changed;
    std::optional<Grown> grown;  // nothing: the insertions are not done
  };
  void start(const Work& to_clear, const Work& to_insert);
  void note_change();
  void note_counters();

  DenseMap map_;  // owned by the task while one is running
  Pose T_base_lidar_;
  std::launch policy_;
  std::future<Result> under_way_;
  Work pending_removal_;  // work whose free-space removal has not begun
  std::optional<std::vector<Pose>> pending_move_;
  std::vector<TileKey> changed_;
  Grown grown_;
  Counters counters_;
};

}  // namespace curbstone::mapper::dense_map
