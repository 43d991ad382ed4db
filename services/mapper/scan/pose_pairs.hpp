#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::scan {

/// Where registration and odometry had the vehicle at the ends of the revolutions of the last second: what they say of
/// the motion since the oldest of them is compared. Pure; one thread.
class PosePairs {
 public:
  static constexpr std::int64_t kSpan = 1'000'000;  ///< us
  /// rad about the vertical, over kSpan. A gyro whose scale is right and a registration that does not slide are tenths
  /// of a degree apart.
  static constexpr double kMostTurn = 0.0175;

  /// A clock that was set back begins anew.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  void clear() { places_.clear(); }
  [[nodiscard]] bool empty() const { return places_.empty(); }
  /// us, of the newest; there must be one. So of the following.
  [[nodiscard]] std::int64_t newest() const { return places_.back().utime; }
  /// How much more the vehicle has turned by the map than by odometry, as a rotation vector in base_link, rad.
  [[nodiscard]] Eigen::Vector3d turned_apart(const Pose& T_map_base, const Pose& T_odom_base) const;
  /// Where odometry has led from the oldest place.
  [[nodiscard]] Pose by_odometry(const Pose& T_odom_base) const;

 private:
  struct Place {
    std::int64_t utime;
    Pose T_map_base, T_odom_base;
  };
  std::deque<Place> places_;
};

}  // namespace curbstone::mapper::scan
