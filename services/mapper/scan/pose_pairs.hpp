#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::scan {

/// Poses by registration and by odometry at the ends of the revolutions of the last second, to compare the motion since
/// the oldest of them. Pure; one thread.
class PosePairs {
 public:
  static constexpr std::int64_t kSpan = 1'000'000;  ///< us
  /// rad about the vertical, over kSpan. A correctly scaled gyro and a registration that does not slide differ by
  /// tenths of a degree.
  static constexpr double kMaxTurnDifference = 0.0175;

  /// Adds a pair. If the clock was set back, the history starts again.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  void clear() { places_.clear(); }
  [[nodiscard]] bool empty() const { return places_.empty(); }
  /// us, of the newest pair. This and the following require at least one pair.
  [[nodiscard]] std::int64_t newest() const { return places_.back().utime; }
  /// us, of the oldest pair, from which motion is compared.
  [[nodiscard]] std::int64_t oldest() const { return places_.front().utime; }
  /// The turn by the map less the turn by odometry, as a rotation vector in base_link, rad.
  [[nodiscard]] Eigen::Vector3d turned_apart(const Pose& T_map_base, const Pose& T_odom_base) const;
  /// The pose in map that odometry predicts, starting from the oldest pair.
  [[nodiscard]] Pose by_odometry(const Pose& T_odom_base) const;

 private:
  struct Place {
    std::int64_t utime;
    Pose T_map_base, T_odom_base;
  };
  std::deque<Place> places_;
};

}  // namespace curbstone::mapper::scan
