#pragma once

#include <cstdint>
#include <memory>

#include "common/geometry/geometry.hpp"
#include "services/mapper/dense_map/dense_worker.hpp"
#include "services/mapper/standstill.hpp"

namespace curbstone::mapper {

/// The dense map of the drive's first standstill. While the vehicle stands, sixteen beams measure the same sixteen
/// rings again and again, and the filter knows its tilt no better than the accelerometer's bias allows: 0.2 degrees
/// displace a ring 19 m ahead by 6 cm from the road surface as it is mapped later, on the move. That would look like a
/// curb. Therefore none of these points becomes part of the drive's map.
///
/// So that the surroundings are visible as soon as the vehicle is switched on, this map is shown until the vehicle has
/// moved and the drive's own map has grown for long enough to replace it. If the vehicle never moves, this map becomes
/// the drive's. One thread.
class StartMap {
 public:
  using Worker = dense_map::DenseWorker;

  /// Arguments as for DenseWorker. After `config.start_hold_s` a vehicle that has not moved is mapped all the same.
  StartMap(const config::DenseConfig& config, const Pose& T_base_lidar, bool threaded,
           std::shared_ptr<SpillFile> spill_file);

  /// Whether the scan that ended at `utime` belongs to the first standstill.
  [[nodiscard]] bool takes(const Standstill& standstill, std::int64_t utime) const;
  /// The map for scans of the first standstill. The first call creates it.
  [[nodiscard]] Worker& map();
  /// A scan of the first standstill that ended at `utime`, us, was added to map().
  void note_scan(std::int64_t utime);
  /// The drive's own map has grown from `began` to `utime`, us. Ends this map if that is long enough, or if this map is
  /// not shown. True if this map was shown and the drive's own map replaces it now.
  [[nodiscard]] bool end_if_replaced(std::int64_t began, std::int64_t utime);
  /// Deletes this map, shown or not. No other one begins.
  void end();
  /// Gives the map away, to become the drive's own map when the vehicle has not moved; null if there is none. As after
  /// end(), no other one begins.
  [[nodiscard]] std::unique_ptr<Worker> hand_over();

  [[nodiscard]] bool is_there() const { return map_ != nullptr; }
  /// Whether this map is published instead of the drive's own: from 0.5 s after its first scan.
  [[nodiscard]] bool is_shown() const { return is_shown_; }
  /// End of its first scan, us; 0: none.
  [[nodiscard]] std::int64_t began() const { return began_; }

 private:
  config::DenseConfig config_;
  Pose T_base_lidar_;
  bool threaded_;
  std::shared_ptr<SpillFile> spill_file_;
  std::unique_ptr<Worker> map_;
  std::int64_t began_ = 0;  // us
  bool is_shown_ = false;
  bool is_over_ = false;
};

}  // namespace curbstone::mapper
