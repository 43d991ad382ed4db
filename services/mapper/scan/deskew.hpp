#pragma once

#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// Constant motion of the vehicle per second, in base_link: velocity v and rotation rate.
struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< m/s
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< rad/s
};

/// Motion along a screw: exp of the twist times `seconds` in SE(3).
[[nodiscard]] Pose move(const Twist& twist, double seconds);
/// The twist that produces `motion` in `seconds`: the log in SE(3), divided by `seconds`. Zero if `seconds` is not
/// positive.
[[nodiscard]] Twist twist_of(const Pose& motion, double seconds);

/// Motion of base_link during a scan: poses at equal time steps, relative to base_link at the end of the scan.
struct SweepMotion {
  double step = 0.001;         ///< s
  std::vector<Pose> T_end_at;  ///< pose at i * step after the scan's start; at least two
};

/// Constant motion throughout a scan of `seconds`.
[[nodiscard]] SweepMotion steady_sweep(const Twist& twist, double seconds, double step = 0.001);

/// Whether a point is a valid measurement: finite, not in the lidar itself (a return of zero), not beyond a kilometre.
[[nodiscard]] bool measured(const LidarPoint& point);

/// Transforms every point from lidar at its own time to base_link at the end of the scan. Between two poses of the
/// sweep the point moves on a straight line: over a millisecond, at 2 rad/s, the error is 5e-7 of the range. Invalid
/// points are left out: see measured().
[[nodiscard]] std::vector<LidarPoint> deskew(const std::vector<LidarPoint>& points, const Pose& T_base_lidar,
                                             const SweepMotion& sweep);

}  // namespace curbstone::mapper::scan
