#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/mapper/config/loam_config.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::registration {

/// Feature points of a scan, after LOAM (Zhang, Singh, RSS 2014, section V.A).
struct RingFeatures {
  std::vector<scan::LidarPoint> edges;   ///< the points of highest curvature of each sector
  std::vector<scan::LidarPoint> planes;  ///< the points of lowest curvature of each sector
  std::vector<scan::LidarPoint> smooth;  ///< all planar points: what the map takes
};

/// Extracts the features. A point's curvature is its distance, in m, from the mean of its ten neighbours on the ring.
/// Left out are points without neighbours, the far side of a step in range (its edge depends on the object that
/// occludes it), and surfaces nearly parallel to the ray. Points are de-skewed, in the lidar's axes or in any that are
/// rotated against these; `lidar` is its position in the same frame. The points of a ring are sorted by time.
[[nodiscard]] RingFeatures ring_features(const std::vector<scan::LidarPoint>& points, const Eigen::Vector3f& lidar,
                                         const config::LoamConfig& config);

}  // namespace curbstone::mapper::registration
