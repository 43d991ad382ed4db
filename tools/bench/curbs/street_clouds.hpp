#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace curbstone {

/// Clouds of a recorded HDL-64 street, in the lidar frame of its first scan.
struct StreetCloud {
  std::string name;
  std::vector<Eigen::Vector3f> points;
};

/// All scans of `folder` (scans/, reference_poses.txt) merged; the first alone; and merged, of each only the beams that
/// an RS-LiDAR-16 has too (every 2 deg from -15). Throws std::runtime_error with one clear line.
[[nodiscard]] std::vector<StreetCloud> read_street_clouds(const std::string& folder);

}  // namespace curbstone
