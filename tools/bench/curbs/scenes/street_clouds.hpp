#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "tools/bench/curbs/scenes/worse_scan.hpp"

namespace curbstone::bench::curbs::scenes {

/// A cloud of a recorded HDL-64 street.
struct StreetCloud {
  std::string name;
  std::vector<Eigen::Vector3f> points;
};

/// All scans of `folder` (scans/, reference_poses.txt) merged; the first alone; and merged, of each only the beams that
/// an RS-LiDAR-16 has too (every 2 deg from -15). Without poses there must be one scan, and it is the first alone.
/// `T_world_first` takes them from the lidar frame of the first scan. Scans are read as a worse sensor would have taken
/// them. Throws std::runtime_error with one clear line.
[[nodiscard]] std::vector<StreetCloud> read_street_clouds(const std::string& folder, const Pose& T_world_first,
                                                          const ScanLoss& loss = {});

}  // namespace curbstone::bench::curbs::scenes
