#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "services/mapper/dense_map.hpp"

namespace curbstone {

/// What a revolution means to the dense map.
struct DenseWork {
  struct Insertion {
    std::vector<LidarPoint> points;  ///< de-skewed, in base_link
    Pose T_map_base;
    std::int64_t utime;   ///< us
    std::int32_t anchor;  ///< of the points that settle now
    bool add_new;         ///< false: only what is known already is looked at
  };
  /// What has left is looked for with the points of the last insertion.
  struct Look {
    Twist motion;               ///< during the revolution
    std::vector<bool> present;  ///< by anchor: its points are where they are seen
    bool on_known_map = false;  ///< those of an earlier drive are, which stand or fall together
  };
  std::vector<Insertion> insertions;
  std::optional<Look> look;
};

/// The dense map, worked on beside its owner: nothing of it is needed to know where the vehicle is, and it costs as
/// much as that. First it grows; what has left is looked for when there is time, look(), or before anything else is
/// done with the map. Every access waits, so the map is a function of what was begun alone: whether there is a second
/// thread or not, and whenever there was time. One thread calls.
class DenseWorker {
 public:
  /// `beside`: in a thread of its own; else when its result is asked for.
  DenseWorker(const DenseConfig& config, const Pose& T_base_lidar, bool beside);
  ~DenseWorker();
  DenseWorker(const DenseWorker&) = delete;
  DenseWorker& operator=(const DenseWorker&) = delete;

  /// Begins, once what was begun before is done.
  void begin(DenseWork work);
  /// Begins to look for what has left, if nobody has yet.
  void look();

  /// When all is done.
  [[nodiscard]] DenseMap& map();
  [[nodiscard]] const DenseMap& map() const;
  /// When it has grown: what has left may be in it still.
  [[nodiscard]] const DenseMap& grown() const;
  /// DenseMap::num_removals() as it was then, whether somebody has had time to look since or not.
  [[nodiscard]] std::int64_t num_removals() const;
  /// Tiles that have changed since the last call, by what has been begun; each may be there more than once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  /// Those that were given up for memory.
  [[nodiscard]] std::vector<TileKey> take_evicted();

 private:
  using Work = std::shared_ptr<const DenseWork>;
  void start(const Work& to_look, const Work& to_grow) const;
  void wait() const;
  void finish() const;

  mutable DenseMap map_;  // whoever looks at it completes it
  Pose T_base_lidar_;
  std::launch policy_;
  mutable std::future<std::vector<TileKey>> under_way_;
  mutable Work to_look_;  // whose look is still to be begun
  mutable std::vector<TileKey> changed_;
  mutable std::optional<std::int64_t> num_removals_;  // nothing: as the map has it
};

}  // namespace curbstone
