#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "tools/bench/curbs/scenes/degraded_scan.hpp"

namespace curbstone::bench::curbs::scenes {

/// A cloud of a recorded HDL-64 street.
struct StreetCloud {
  std::string name;
  std::vector<Eigen::Vector3f> points;
};

/// Reads three clouds from `folder` (scans/, reference_poses.txt): all scans merged, the first scan alone, and all
/// scans merged with only the beams that an RS-LiDAR-16 has too (every 2 deg from -15). Without poses there must be
/// exactly one scan, which is the first alone. `T_world_first` transforms from the lidar frame of the first scan.
/// `loss` degrades the scans to those of a worse sensor. Throws std::runtime_error with a one-line message.
[[nodiscard]] std::vector<StreetCloud> read_street_clouds(const std::string& folder, const Pose& T_world_first,
                                                          const ScanLoss& loss = {});

}  // namespace curbstone::bench::curbs::scenes
