#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::simulate::recorded {

/// All points of a scan in KITTI's format (float32 x y z intensity), as the file has them: some may not be finite.
struct ScanFile {
  std::vector<Eigen::Vector3f> positions;  ///< m, lidar frame
  std::vector<std::uint8_t> intensities;   ///< of each point; 0: none
  std::vector<std::uint8_t> rings;         ///< of each point, numbered upwards: rings_of()
};

/// Throws std::runtime_error if the file cannot be read or is truncated.
[[nodiscard]] ScanFile read_scan_file(const std::string& file);

}  // namespace curbstone::simulate::recorded
