#pragma once

#include <Eigen/Core>

#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::simulate::recorded {

/// Which way is up in the lidar frame of the first scan, by the ground around the vehicle in several scans: good to the
/// slope of the street, a degree or two. `height` m is the lidar's above the ground. Yaw stays as it is.
[[nodiscard]] Eigen::Matrix3d level(const ScanSet& scans, double height);

}  // namespace curbstone::simulate::recorded
