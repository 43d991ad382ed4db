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

/// What a scan means to the dense map.
struct DenseWork {
  struct Insertion {
    scan::SharedPoints points;  ///< de-skewed, in base_link
    Pose T_map_base;
    std::int64_t utime;   ///< us
    std::int32_t anchor;  ///< keyframe of the points that settle with this scan
    bool add_new;         ///< false: only voxels that are known already take the points
    std::shared_ptr<const intensity::RingTable> scale = nullptr;  ///< of their intensities: DenseMap::set_scale()
  };
  /// What has left is looked for with the points of the last insertion.
  struct Look {
    scan::Twist motion;         ///< during the scan
    std::vector<bool> present;  ///< by anchor: its points are where they are seen
    bool on_known_map = false;  ///< so are those of an earlier drive, which stand or fall together
  };
  std::vector<Insertion> insertions;
  std::optional<Look> look;
};

/// Works on the dense map in a thread of its own: the pose needs nothing of it, and it costs as much as the pose. First
/// the map grows by the insertions. Removing what has left, the look, waits until look(), or until anything else is
/// done with the map. So the map is a function of the calls, with a second thread or without. One thread calls.
///
/// Only the calls that say so wait. The const ones never do: they throw std::logic_error where they are asked for
/// something that is still being worked on.
class DenseWorker {
 public:
  /// `beside`: in a thread of its own; else within the wait for it. `far`: as for DenseMap.
  DenseWorker(const config::DenseConfig& config, const Pose& T_base_lidar, bool beside,
              std::shared_ptr<SpillFile> far = std::make_shared<SpillFile>());
  ~DenseWorker();
  DenseWorker(const DenseWorker&) = delete;
  DenseWorker& operator=(const DenseWorker&) = delete;

  /// Begins work, once the work begun earlier is done: waits for that.
  void begin(DenseWork work);
  /// Begins the look of the last work unless it has begun. Waits for the work under way only if there is such a look.
  void look();
  /// Waits until the map has grown. What has left may still be in it.
  void wait_grown();
  /// Waits until all is done, the look too.
  void wait();

  /// Each of these changes the map as DenseMap's own do. Waits until all is done first.
  void load(TileKey key, std::int32_t z_origin, std::int64_t utime, const std::vector<TilePoint>& points);
  void restore(TileKey key, std::int32_t z_origin, TileRecords records, const Eigen::Vector3d& at);
  void move(const std::vector<Pose>& corrections);
  void roll_back(std::int64_t utime);
  [[nodiscard]] std::vector<TileKey> finish();

  /// After wait(), or one of those that change the map.
  [[nodiscard]] const DenseMap& map() const;
  /// After wait_grown().
  [[nodiscard]] const DenseMap& grown() const;

  /// DenseMap::num_removals() when the map had last grown, or was last changed.
  [[nodiscard]] std::int64_t num_removals() const { return grown_.num_removals; }
  /// DenseMap::is_moving(), likewise.
  [[nodiscard]] bool is_moving() const { return grown_.is_moving; }
  /// Those of the map when it was last waited for.
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Tiles that the work waited for has changed since the last call; each may be there more than once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  /// take_changed() has all tiles. After wait_grown().
  void note_all_changed() { changed_ = grown().keys(); }
  /// Tiles that were given up for memory. After wait_grown().
  [[nodiscard]] std::vector<TileKey> take_evicted();

 private:
  using Work = std::shared_ptr<const DenseWork>;
  /// What is known of the map once it has grown.
  struct Grown {
    std::int64_t num_removals = 0;
    bool is_moving = false;
  };
  struct Result {
    std::vector<TileKey> changed;
    std::optional<Grown> grown;  // nothing: it has not
  };
  void start(const Work& to_look, const Work& to_grow);
  void note_change();

  DenseMap map_;  // the task's, while one is under way
  Pose T_base_lidar_;
  std::launch policy_;
  std::future<Result> under_way_;
  Work to_look_;  // whose look is still to begin
  std::vector<TileKey> changed_;
  Grown grown_;
  Counters counters_;
};

}  // namespace curbstone::mapper::dense_map
