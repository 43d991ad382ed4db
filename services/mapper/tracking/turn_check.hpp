#pragma once

#include <cstdint>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/pose_pairs.hpp"

namespace curbstone::mapper::tracking {

/// Whether a registration turns otherwise than odometry. If the gyro's scale is right, such a registration follows
/// something large on both sides that drives along with the vehicle: most of the scan's points stand still in
/// base_link.
///
/// It does not see what slides by less than PosePairs::kMostTurn in a second, nor what slides without turning: on a
/// straight road max_jump_m alone tells.
///
/// Pure; one thread.
class TurnCheck {
 public:
  static constexpr std::int64_t kPatience = 10'000'000;  ///< us: for so long odometry is believed rather than scans

  /// A scan that ended at `utime`, us, was believed.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
    believed_.add(utime, T_map_base, T_odom_base);
  }
  void clear() { believed_.clear(); }
  /// Whether a pose by registration contradicts odometry.
  [[nodiscard]] bool contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const;
  /// Whether no scan has been believed for so long that scans are right, perhaps, and odometry is not.
  [[nodiscard]] bool gives_up(std::int64_t utime) const;
  /// Where odometry has led from a second before the last scan that was believed: before the registration began to
  /// slide. One must have been.
  [[nodiscard]] Pose by_odometry(const Pose& T_odom_base) const { return believed_.by_odometry(T_odom_base); }

 private:
  scan::PosePairs believed_;
};

}  // namespace curbstone::mapper::tracking
