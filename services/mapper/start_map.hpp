#pragma once

#include <cstdint>
#include <memory>

#include "common/geometry/geometry.hpp"
#include "services/mapper/dense_map/dense_worker.hpp"
#include "services/mapper/standstill.hpp"

namespace curbstone::mapper {

/// The dense map of the drive's first standstill. Standing, sixteen beams draw the same sixteen rings again and again,
/// and the filter does not know its tilt to better than the accelerometer's bias: 0.2 degrees put a ring 19 m ahead
/// 6 cm off the road as it is found to be on the way, which is a curb to look at. So none of it becomes part of the
/// drive's map. But who switches the vehicle on wants to see what is about it: this map is shown until the vehicle has
/// moved and the drive's own map shows as much. Where the vehicle never moves, this is the map. One thread.
class StartMap {
 public:
  using Worker = dense_map::DenseWorker;

  /// `seconds`: after which a vehicle that has not moved is mapped all the same. The rest as for DenseWorker.
  StartMap(const config::DenseConfig& config, const Pose& T_base_lidar, bool beside, std::shared_ptr<SpillFile> far);

  /// Whether the scan that ended at `utime` belongs to the first standstill.
  [[nodiscard]] bool takes(const Standstill& standstill, std::int64_t utime) const;
  /// The map that such a scan goes into, which begins with the first one.
  [[nodiscard]] Worker& map();
  /// It has such a scan of `utime`.
  void grew(std::int64_t utime);
  /// The drive's own map has grown since `began` until `utime`, us. True when it is shown from now on, instead of this
  /// one: which is no more.
  [[nodiscard]] bool gives_way(std::int64_t began, std::int64_t utime);
  /// It is no more, shown or not, and none begins.
  void end();
  /// For the drive that never began: what there is becomes its map; null if nothing is. No more here.
  [[nodiscard]] std::unique_ptr<Worker> hand_over();

  [[nodiscard]] bool is_there() const { return map_ != nullptr; }
  /// Whether listeners see it, rather than the drive's own map. Not before it shows something.
  [[nodiscard]] bool is_shown() const { return is_shown_; }
  /// Its first scan; 0: none.
  [[nodiscard]] std::int64_t began() const { return began_; }

 private:
  config::DenseConfig config_;
  Pose T_base_lidar_;
  bool beside_;
  std::shared_ptr<SpillFile> far_;
  std::unique_ptr<Worker> map_;
  std::int64_t began_ = 0;  // us
  bool is_shown_ = false;
  bool is_over_ = false;
};

}  // namespace curbstone::mapper
