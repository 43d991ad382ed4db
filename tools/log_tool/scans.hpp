#pragma once

#include <array>
#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/scan_assembler.hpp"

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

/// Assembles the packets of LIDAR_POINTS into revolutions, as the mapper does, but of all ranges. Non-finite points are
/// left out.
class ScanCollector {
 public:
  using OnScan = std::function<void(const LoggedScan&)>;

  explicit ScanCollector(OnScan on_scan)
      : on_scan_(std::move(on_scan)),
        assembler_({.min_range = 0, .max_range = std::numeric_limits<double>::infinity()}) {}
  void take(const lidar_points_t& message);
  /// Completes the last revolution.
  void finish();
  /// Packets that came twice, or after their revolution.
  [[nodiscard]] std::int64_t left_out() const;

 private:
  void pass(const std::optional<mapper::scan::Scan>& scan);

  OnScan on_scan_;
  mapper::scan::ScanAssembler assembler_;
  LoggedScan scan_;  // keeps its memory
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
  /// Whether at() has a pose.
  [[nodiscard]] bool reaches(std::int64_t utime) const { return around(utime).has_value(); }
  [[nodiscard]] bool empty() const { return poses_.empty(); }

 private:
  using Poses = std::map<std::int64_t, Pose>;  // by time, us

  /// Whether a message of this epoch and time counts.
  bool follow(std::int32_t epoch, std::int64_t utime);
  /// The poses to interpolate between: twice the same one if it is of that time.
  [[nodiscard]] std::optional<std::pair<Poses::const_iterator, Poses::const_iterator>> around(std::int64_t utime) const;

  std::int32_t epoch_ = 0;
  Poses poses_;
};

/// A PCD file that is written scan by scan. All functions throw std::runtime_error if the file cannot be written.
class ScanPcdFile {
 public:
  /// `count`: of all points, which the header has.
  ScanPcdFile(const std::string& file, std::size_t count);
  void add(const std::vector<ScanPoint>& points);
  /// Throws, too, if the points are not as many as were promised: then the header is wrong.
  void finish();

 private:
  std::string file_;
  std::ofstream out_;
  std::size_t missing_;  // of the promised points
};

}  // namespace curbstone::log_tool
