#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/pose_pairs.hpp"

namespace curbstone::mapper::tracking {

/// Whether a registration turns otherwise than odometry in which wheels and gyro agree, after they and the scans have
/// agreed for long. Such a registration follows something large on both sides that drives along with the vehicle: most
/// of the scan's points stand still in base_link. A gyro whose scale is wrong turns otherwise than the wheels in a
/// bend; one whose bias has leapt does until the filter has learnt to explain it, and otherwise than the scans ever
/// after. Neither is believed against the scans.
///
/// It does not see what slides by less than PosePairs::kMostTurn in a second, nor what slides without turning: on a
/// straight road max_jump_m alone tells.
///
/// Pure; one thread.
class TurnCheck {
 public:
  static constexpr std::int64_t kPatience = 10'000'000;   ///< us: for so long odometry is believed rather than scans
  static constexpr std::int64_t kProbation = 10'000'000;  ///< us: for so long they must have agreed before

  /// A scan that ended at `utime`, us, was believed.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  /// The map's frame has moved, or odometry has a gap: what comes is not compared with what was.
  void clear() { believed_.clear(); }
  /// Whether a pose by registration contradicts odometry that is to be believed rather.
  [[nodiscard]] bool contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const;
  /// Whether no scan has been believed for so long that scans are right, perhaps, and odometry is not.
  [[nodiscard]] bool gives_up(std::int64_t utime) const;
  /// Where odometry has led from a second before the last scan that was believed: before the registration began to
  /// slide. One must have been.
  [[nodiscard]] Pose by_odometry(const Pose& T_odom_base) const { return believed_.by_odometry(T_odom_base); }

 private:
  [[nodiscard]] bool apart(const Pose& T_map_base, const Pose& T_odom_base) const;

  scan::PosePairs believed_;
  std::optional<std::int64_t> apart_;  // us, when odometry and a scan that was believed last differed, or the start
};

}  // namespace curbstone::mapper::tracking
