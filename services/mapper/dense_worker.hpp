#pragma once

#include <cstdint>
#include <future>
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
/// much as that. Every access waits for the work under way, so the map is a function of the calls alone, whether there
/// is a second thread or not. One thread calls.
class DenseWorker {
 public:
  /// `beside`: in a thread of its own; else when its result is asked for.
  DenseWorker(const DenseConfig& config, const Pose& T_base_lidar, bool beside);
  ~DenseWorker();
  DenseWorker(const DenseWorker&) = delete;
  DenseWorker& operator=(const DenseWorker&) = delete;

  /// Begins, once what was begun before is done.
  void begin(DenseWork work);
  [[nodiscard]] DenseMap& map();
  [[nodiscard]] const DenseMap& map() const;
  /// Tiles that have changed since the last call; each may be there more than once.
  [[nodiscard]] std::vector<TileKey> take_changed();

 private:
  void wait() const;
  [[nodiscard]] std::vector<TileKey> work_in(const DenseWork& work);

  DenseMap map_;
  Pose T_base_lidar_;
  std::launch policy_;
  mutable std::future<std::vector<TileKey>> under_way_;
  mutable std::vector<TileKey> changed_;
};

}  // namespace curbstone
