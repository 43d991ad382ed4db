#pragma once

#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// Steady motion: what the vehicle does each second, in base_link. v, then rotation rate.
struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< m/s
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< rad/s
};

/// The motion of a screw: exp of the twist times `seconds` in SE(3).
[[nodiscard]] Pose move(const Twist& twist, double seconds);
/// The twist that makes `motion` in `seconds`: the log in SE(3), divided. Zero when `seconds` is not above zero.
[[nodiscard]] Twist twist_of(const Pose& motion, double seconds);

/// Where base_link was during a scan, seen from where it is at the end: poses at even steps of time.
struct SweepMotion {
  double step = 0.001;         ///< s
  std::vector<Pose> T_end_at;  ///< at i * step after the scan's start; at least two
};

/// Steady motion all through a scan of `seconds`.
[[nodiscard]] SweepMotion steady_sweep(const Twist& twist, double seconds, double step = 0.001);

/// Whether a point of the LiDAR can be one: finite, not in the lidar itself (a return of zero), not beyond a kilometre.
[[nodiscard]] bool measured(const LidarPoint& point);

/// Takes every point from lidar at its own time to base_link at the end of the scan. Between two steps of the
/// sweep the point moves on a straight line: within a millisecond, at 2 rad/s, that is off by 5e-7 of the range.
/// Points that are no measurement are left out: see measured().
[[nodiscard]] std::vector<LidarPoint> deskew(const std::vector<LidarPoint>& points, const Pose& T_base_lidar,
                                             const SweepMotion& sweep);

}  // namespace curbstone::mapper::scan
