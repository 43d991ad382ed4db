#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/viewer/frames/sections.hpp"

namespace curbstone::viewer {

/// The last whole revolution of the LiDAR, thinned. A point is where it was measured from: 5 cm off at 1 m/s at most,
/// as nothing is de-skewed here. Pure; one thread.
class Scan {
 public:
  /// `max_points` of a revolution.
  Scan(const Pose& T_base_lidar, int max_points);

  /// False: not one that can be drawn.
  bool put(const lidar_points_t& message);

  /// In base_link.
  [[nodiscard]] const std::vector<frames::ScanPoint>& points() const { return done_; }
  /// Grows with each revolution.
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  void finish(std::int32_t next);

  Eigen::Isometry3f T_base_lidar_;
  std::size_t max_points_;
  std::size_t stride_ = 1;   // every so many points are taken
  std::size_t counted_ = 0;  // of the present revolution
  std::int32_t revolution_ = -1;
  std::vector<frames::ScanPoint> filling_;
  std::vector<frames::ScanPoint> done_;
  std::uint64_t number_ = 0;
};

}  // namespace curbstone::viewer
