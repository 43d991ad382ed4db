#pragma once

#include <Eigen/Core>

#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::simulate::recorded {

/// The rotation that levels the lidar frame of the first scan, from the ground around the vehicle in several scans:
/// accurate to the slope of the street, a degree or two. `height`: of the lidar above the ground, m. Yaw is unchanged.
[[nodiscard]] Eigen::Matrix3d level(const ScanSet& scans, double height);

}  // namespace curbstone::simulate::recorded
