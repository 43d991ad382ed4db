#pragma once

#include <cstdint>
#include <deque>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::tracking {

/// Compares how a scan says that the vehicle has turned over the last second with how odometry does. A gyro whose scale
/// is right is off by tenths of a degree in so short a time. A registration that is off by more follows something
/// large that drives along beside the vehicle: most of the scan's points stand still in base_link.
///
/// Pure; one thread.
class TurnCheck {
 public:
  static constexpr std::int64_t kSpan = 1'000'000;       ///< us
  static constexpr double kMost = 0.0175;                ///< rad
  static constexpr std::int64_t kPatience = 10'000'000;  ///< us: for so long odometry is believed rather than scans

  /// A scan that ended at `utime`, us, was believed.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  void clear() { places_.clear(); }
  /// Whether a pose by registration contradicts odometry.
  [[nodiscard]] bool contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const;
  /// Whether no scan has been believed for so long that scans are right, perhaps, and odometry is not.
  [[nodiscard]] bool gives_up(std::int64_t utime) const;
  /// Where odometry has led from the oldest scan of the last second: before the registration began to slide. There must
  /// be one.
  [[nodiscard]] Pose by_odometry(const Pose& T_odom_base) const;

 private:
  struct Place {
    std::int64_t utime;
    Pose T_map_base, T_odom_base;
  };
  std::deque<Place> places_;
};

}  // namespace curbstone::mapper::tracking
