#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::test {

/// What `box`, m in lidar, hides in a scan is seen on the box instead: an object that moves with the vehicle.
inline void put_companion(const Eigen::AlignedBox3f& box, mapper::scan::Scan& scan) {
  for (mapper::scan::LidarPoint& point : scan.points) {
    float enters = 0, leaves = std::numeric_limits<float>::max();  // as multiples of the point
    for (Eigen::Index i = 0; i < 3; ++i) {
      const float p = point.position[i], low = box.min()[i] / p, high = box.max()[i] / p;
      enters = std::max(enters, std::min(low, high));
      leaves = std::min(leaves, std::max(low, high));
    }
    if (enters > 0 && enters < leaves && enters < 1) point.position *= enters;
  }
}

/// A bus in the next lane, on the left of the default vehicle.
inline Eigen::AlignedBox3f bus() {
  return {Eigen::Vector3f(-6, 2, -1.7F), Eigen::Vector3f(6, 4.5F, 1.3F)};
}

}  // namespace curbstone::test
