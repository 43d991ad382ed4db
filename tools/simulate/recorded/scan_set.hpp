#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::simulate::recorded {

/// One recorded point.
struct ScanPoint {
  Eigen::Vector3f position;    ///< m, lidar frame of its scan
  std::uint8_t intensity = 0;  ///< 0: none
  std::uint8_t laser = 0;      ///< numbered upwards: rings_of()
};

/// A recorded drive: scans in KITTI's format, with the pose of each.
struct ScanSet {
  std::string folder;
  std::vector<std::string> files;  ///< one per scan, in order
  std::vector<Pose> T_first_scan;  ///< pose of each scan in the lidar frame of the first
  std::vector<double> times;       ///< s from the first scan, increasing
  /// Not de-skewed: each point was measured when the head pointed at it.
  bool swept = false;

  [[nodiscard]] double period() const { return (times.back() - times.front()) / static_cast<double>(times.size() - 1); }
};

/// Finds the scans. `folder` holds *.bin, or a folder velodyne/ or scans/ that does. Without `times_file`, times.txt
/// next to the poses is used, else 10 Hz. Scans with a folder of rings next to them are single sweeps as measured.
/// Throws std::runtime_error with a one-line message that says what is missing or inconsistent.
[[nodiscard]] ScanSet find_scans(const std::string& folder, const std::string& poses_file,
                                 const std::string& times_file);

/// The finite points of a scan that are farther than a metre. Throws std::runtime_error if the file is truncated.
[[nodiscard]] std::vector<ScanPoint> read_scan(const std::string& file);

}  // namespace curbstone::simulate::recorded
