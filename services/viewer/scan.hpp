#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/viewer/frames/sections.hpp"

namespace curbstone::viewer {

/// The last complete LiDAR revolution, thinned. The points are not de-skewed: each is relative to the vehicle at the
/// time of its measurement, an error of at most 5 cm at 1 m/s. Pure; one thread.
class Scan {
 public:
  /// `max_points`: kept of a revolution.
  Scan(const Pose& T_base_lidar, int max_points);

  /// False: the message is invalid.
  bool put(const lidar_points_t& message);

  /// In base_link.
  [[nodiscard]] const std::vector<frames::ScanPoint>& points() const { return done_; }
  /// Increases with each revolution.
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  void finish(std::int32_t next);

  Eigen::Isometry3f T_base_lidar_;
  std::size_t max_points_;
  std::size_t stride_ = 1;   // one point of `stride_` is kept
  std::size_t counted_ = 0;  // points of the present revolution so far
  std::int32_t revolution_ = -1;
  std::vector<frames::ScanPoint> filling_;
  std::vector<frames::ScanPoint> done_;
  std::uint64_t number_ = 0;
};

}  // namespace curbstone::viewer
