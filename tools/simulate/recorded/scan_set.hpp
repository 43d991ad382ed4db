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
  std::uint8_t laser = 0;      ///< counted upwards: rings_of()
};

/// A recorded drive: scans in KITTI's format, with the pose of each.
struct ScanSet {
  std::string folder;
  std::vector<std::string> files;  ///< one a scan, in order
  std::vector<Pose> T_first_scan;  ///< pose of each scan in the lidar frame of the first
  std::vector<double> times;       ///< s from the first scan, increasing
  /// The sweep was not put right for the vehicle's motion: a point was measured when the head looked its way.
  bool swept = false;

  [[nodiscard]] double period() const { return (times.back() - times.front()) / static_cast<double>(times.size() - 1); }
};

/// `folder` holds *.bin, or a folder velodyne/ or scans/ that does. Without `times_file` it is times.txt beside the
/// poses, else 10 Hz. Scans with a folder of rings beside them are single sweeps as measured. Throws std::runtime_error
/// with one clear line: what is missing, or does not fit together.
[[nodiscard]] ScanSet find_scans(const std::string& folder, const std::string& poses_file,
                                 const std::string& times_file);

/// Points of a scan that are finite and farther than a metre. Throws std::runtime_error when the file is cut off.
[[nodiscard]] std::vector<ScanPoint> read_scan(const std::string& file);

}  // namespace curbstone::simulate::recorded
