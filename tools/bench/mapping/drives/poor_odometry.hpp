#pragma once

#include <vector>

#include "services/mapper/scan/odometry_history.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping::drives {

/// Errors of the odometry.
struct OdometryErrors {
  double scale = 1.02;                 ///< of the distance: wheels smaller than configured
  double yaw_rate = 0.2 / 57.2957795;  ///< rad/s, gyro bias
};

/// Simulates the odometry of poor sensors at 100 Hz: the truth's motion with errors, integrated. The motion is constant
/// between the truth's poses and for `beyond` us past its ends. The truth needs at least two poses.
[[nodiscard]] std::vector<mapper::scan::OdometrySample> poor_odometry(const evaluate::truth::Trajectory& truth,
                                                                      const OdometryErrors& errors,
                                                                      std::int64_t beyond);

}  // namespace curbstone::bench::mapping::drives
