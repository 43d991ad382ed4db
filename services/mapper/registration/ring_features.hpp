#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/mapper/config/loam_config.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::registration {

/// Points of a scan that tell where it was taken, after LOAM (Zhang, Singh, RSS 2014, section V.A).
struct RingFeatures {
  std::vector<scan::LidarPoint> edges;   ///< the most bent of each sector
  std::vector<scan::LidarPoint> planes;  ///< the least bent of each sector
  std::vector<scan::LidarPoint> smooth;  ///< all that are plane: what the map takes
};

/// A point's bend is how far, in m, it stands off the mean of its ten neighbours on the ring. Left out: points without
/// neighbours, the far side of a step in range (what hides it decides where it ends), and surfaces nearly along the
/// ray. Points are in the lidar's axes or any that were turned since, de-skewed; `lidar` is where it was. A ring's
/// points are put in the order of their times.
[[nodiscard]] RingFeatures ring_features(const std::vector<scan::LidarPoint>& points, const Eigen::Vector3f& lidar,
                                         const config::LoamConfig& config);

}  // namespace curbstone::mapper::registration
