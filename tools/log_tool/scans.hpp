#pragma once

#include <array>
#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::log_tool {

/// A point of a PCD file: m, intensity 0..255, the ring, s after the scan's first point.
struct ScanPoint {
  float x, y, z, intensity, ring, t;
};
static_assert(sizeof(ScanPoint) == 24);

/// The points of a revolution, in the frame lidar.
struct LoggedScan {
  std::int32_t revolution = 0;
  std::int64_t utime = 0;  ///< us, the first packet
  std::vector<ScanPoint> points;
};

/// Assembles the packets of LIDAR_POINTS into revolutions. Non-finite points are left out.
class ScanCollector {
 public:
  using OnScan = std::function<void(const LoggedScan&)>;

  explicit ScanCollector(OnScan on_scan) : on_scan_(std::move(on_scan)) {}
  void take(const lidar_points_t& message);
  /// Completes the last revolution.
  void finish();

 private:
  OnScan on_scan_;
  LoggedScan scan_;
};

/// The vehicle's trajectory from MAP_POSE and MAP_TRAJECTORY, interpolated between their poses: in the map's last
/// epoch, as the mapper corrected it. Poses of earlier epochs are void: a closed loop has moved them, or their map had
/// another frame.
class LoggedPath {
 public:
  void take(const map_pose_t& message);
  void take(const map_trajectory_t& message);
  /// T_map_base at that time, us. Empty before the first pose, after the last, and where the vehicle drove between two
  /// that are 1 s or more apart.
  [[nodiscard]] std::optional<Pose> at(std::int64_t utime) const;
  [[nodiscard]] bool empty() const { return poses_.empty(); }

 private:
  /// Whether a message of this epoch and time counts.
  bool follow(std::int32_t epoch, std::int64_t utime);

  std::int32_t epoch_ = 0;
  std::map<std::int64_t, Pose> poses_;
};

/// Throws std::runtime_error if the file cannot be written.
void write_scan_pcd(const std::vector<ScanPoint>& points, const std::string& file);

}  // namespace curbstone::log_tool
