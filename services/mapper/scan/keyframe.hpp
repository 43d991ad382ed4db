#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// A point of a kept scan, in base_link, in kPositionStep: 65 m reach either way.
struct KeyframePoint {
  std::int16_t x = 0;
  std::int16_t y = 0;
  std::int16_t z = 0;
  bool operator==(const KeyframePoint&) const = default;
};

/// Nothing beyond the reach of int16.
[[nodiscard]] inline std::optional<KeyframePoint> pack(const Eigen::Vector3f& point) {
  const Eigen::Array3f steps = (point.array() / static_cast<float>(kPositionStep)).round();
  if (!(steps.abs() <= 32767.0F).all()) return std::nullopt;
  return KeyframePoint{static_cast<std::int16_t>(steps.x()), static_cast<std::int16_t>(steps.y()),
                       static_cast<std::int16_t>(steps.z())};
}

[[nodiscard]] inline Eigen::Vector3f unpack(const KeyframePoint& point) {
  return static_cast<float>(kPositionStep) * Eigen::Vector3f(point.x, point.y, point.z);
}

/// As registration takes points.
[[nodiscard]] inline std::vector<LidarPoint> unpack(const std::vector<KeyframePoint>& points) {
  std::vector<LidarPoint> unpacked(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) unpacked[i].position = unpack(points[i]);
  return unpacked;
}

/// A place on the drive from which the surroundings are remembered: one thinned scan and where it was taken.
/// Whatever must be built anew (the map for registration after a loop was closed, after a rollback, from a saved map)
/// is built from these; the pose graph moves them.
struct Keyframe {
  std::int64_t utime = 0;  ///< us, end of its scan
  Pose T_map_base = Pose::Identity();
  std::vector<KeyframePoint> points;  ///< de-skewed, in base_link
};

}  // namespace curbstone::mapper::scan
