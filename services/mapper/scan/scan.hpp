#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace curbstone::mapper::scan {

/// One return of the LiDAR. The frame depends on the stage: lidar when assembled, base_link once de-skewed.
struct LidarPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m
  float time = 0;                                      ///< s after Scan::start
  std::uint8_t intensity = 0;
  std::uint8_t ring = 0;
};

/// De-skewed points of a scan, shared instead of copied: the dense map's thread still reads them while the next scan is
/// registered.
using SharedPoints = std::shared_ptr<const std::vector<LidarPoint>>;

/// All returns of one revolution of the LiDAR, in the order in which its packets came.
struct Scan {
  std::int32_t number = 0;   ///< lidar_points_t.revolution
  std::int64_t start = 0;    ///< us, when the first laser fired
  std::int64_t end = 0;      ///< us, when the last point was taken
  std::int32_t packets = 0;  ///< received
  std::int64_t lost = 0;     ///< missing, by the gaps in the sequence numbers
  std::vector<LidarPoint> points;
};

/// Converts us to s.
[[nodiscard]] inline double seconds(std::int64_t from, std::int64_t to) {
  return static_cast<double>(to - from) * 1e-6;
}

}  // namespace curbstone::mapper::scan
