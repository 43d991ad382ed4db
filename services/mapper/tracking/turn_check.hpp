#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/pose_pairs.hpp"

namespace curbstone::mapper::tracking {

/// Detects a registration whose turn contradicts odometry, where wheels and gyro agree and odometry agreed with the
/// scans for a long time before. Such a registration follows something large on both sides that drives along with the
/// vehicle: most of the scan's points stand still in base_link. A faulty gyro does not outvote the scans: one with a
/// wrong scale contradicts the wheels in a bend; one whose bias leapt contradicts the wheels until the filter explains
/// it, and from then on the scans. A bias that grows, as in a device that warms up, turns odometry away slowly, while
/// a registration begins to slide suddenly: the mean drift of the last seconds is no contradiction.
///
/// It does not detect a registration that slides by less than PosePairs::kMaxTurnDifference in a second, or without
/// turning: on a straight road only max_jump_m does.
///
/// Pure; one thread.
class TurnCheck {
 public:
  static constexpr std::int64_t kPatience = 10'000'000;   ///< us for which odometry is used instead of scans
  static constexpr std::int64_t kProbation = 10'000'000;  ///< us for which both must have agreed before
  static constexpr double kDriftTime = 5;                 ///< s over which the drift of odometry's turn is averaged

  /// Adds an accepted scan that ended at `utime`, us.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  /// Clears the history, as the map's frame has moved or odometry has a gap: later poses are not compared with earlier
  /// ones.
  void clear() { believed_.clear(); }
  /// Whether a registered pose contradicts odometry, and odometry should be used instead.
  [[nodiscard]] bool contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const;
  /// Whether no scan has been accepted for kPatience, or none at all: the scans may be right, and odometry wrong.
  [[nodiscard]] bool gives_up(std::int64_t utime) const;
  /// The pose in map that odometry predicts from a second before the last accepted scan, before the registration began
  /// to slide. Requires an accepted scan.
  [[nodiscard]] Pose by_odometry(const Pose& T_odom_base) const { return believed_.by_odometry(T_odom_base); }

 private:
  [[nodiscard]] double turned_apart(const Pose& T_map_base, const Pose& T_odom_base) const;
  void follow_drift(std::int64_t utime, double apart);

  scan::PosePairs believed_;
  std::int64_t since_ = 0;                 // us, of the first accepted scan of this history
  double drift_ = 0;                       // rad/s, mean turn by accepted scans less that by odometry
  std::optional<std::int64_t> disagreed_;  // us, when odometry last differed from an accepted scan, or start
};

}  // namespace curbstone::mapper::tracking
