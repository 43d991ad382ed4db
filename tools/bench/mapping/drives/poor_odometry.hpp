#pragma once

#include <vector>

#include "services/mapper/scan/odometry_history.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping::drives {

/// How bad odometry is.
struct OdometryErrors {
  double scale = 1.02;                 ///< of the distance: wheels that are smaller than believed
  double yaw_rate = 0.2 / 57.2957795;  ///< rad/s: a gyro's bias
};

/// Odometry at 100 Hz as poor sensors would have it: the truth's motion (steady between its poses, and beyond its ends
/// for `beyond` us) with errors, integrated. The truth needs two poses at least.
[[nodiscard]] std::vector<mapper::scan::OdometrySample> poor_odometry(const evaluate::truth::Trajectory& truth,
                                                                      const OdometryErrors& errors,
                                                                      std::int64_t beyond);

}  // namespace curbstone::bench::mapping::drives
