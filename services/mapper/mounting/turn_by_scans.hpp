#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/azimuth_profile.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// Measures the error of odometry's turn by the azimuth profiles of the scans, for odometry without a gyro, or with one
/// that the wheels contradict. A wheel that slips turns odometry without a gyro by degrees within half a second, and
/// wheels that were never compared with a gyro by half a degree a second; a gyro whose bias leaps does likewise. Where
/// only trees stand, registration has no surface that would show it.
///
/// Each scan is compared with a reference scan, at most kMaxAge and kMaxDistance back, by odometry's motion between
/// them. A comparison is good to about 0.05 deg, and the next reference carries its error on. Pure; one thread.
class TurnByScans {
 public:
  static constexpr std::int64_t kMaxAge = 500'000;  ///< us
  static constexpr double kMaxDistance = 2.0;       ///< m

  /// `lidar`: position in base_link, m.
  explicit TurnByScans(const Eigen::Vector3d& lidar) : lidar_(lidar) {}

  /// Takes the next scan: its end, us; its de-skewed points in base_link; odometry's pose. Returns the error of
  /// odometry's turn since the last scan, rad, positive where odometry turned too far to the left; 0 if unknown.
  [[nodiscard]] double error_since_last(std::int64_t utime, const std::vector<scan::LidarPoint>& points,
                                        const Pose& T_odom_base);
  /// The next scan does not follow the last one, or wheels and gyro agree on the turn.
  void interrupt() { reference_.reset(); }

 private:
  struct Reference {
    std::int64_t utime;
    Pose T_odom_base;
    AzimuthProfile profile;
  };
  void start_from(std::int64_t utime, const std::vector<scan::LidarPoint>& points, const Pose& T_odom_base);

  Eigen::Vector3d lidar_;
  std::optional<Reference> reference_;
  double error_ = 0;  // rad, of odometry's turn since the reference, as returned so far
};

}  // namespace curbstone::mapper::mounting
