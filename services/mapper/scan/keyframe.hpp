#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/packing/spill_file.hpp"
#include "common/tiles/tile.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// A point of a keyframe in base_link, in units of kPositionStep: reaches 65 m either way.
struct KeyframePoint {
  std::int16_t x = 0;
  std::int16_t y = 0;
  std::int16_t z = 0;
  bool operator==(const KeyframePoint&) const = default;
};

/// Quantises a point; nothing if it is beyond the range of int16.
[[nodiscard]] inline std::optional<KeyframePoint> pack(const Eigen::Vector3f& point) {
  const Eigen::Array3f steps = (point.array() / static_cast<float>(kPositionStep)).round();
  if (!(steps.abs() <= 32767.0F).all()) return std::nullopt;
  return KeyframePoint{static_cast<std::int16_t>(steps.x()), static_cast<std::int16_t>(steps.y()),
                       static_cast<std::int16_t>(steps.z())};
}

[[nodiscard]] inline Eigen::Vector3f unpack(const KeyframePoint& point) {
  return static_cast<float>(kPositionStep) * Eigen::Vector3f(point.x, point.y, point.z);
}

/// Converts the points to what registration takes.
[[nodiscard]] inline std::vector<LidarPoint> unpack(const std::vector<KeyframePoint>& points) {
  std::vector<LidarPoint> unpacked(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) unpacked[i].position = unpack(points[i]);
  return unpacked;
}

/// The points of a keyframe, in memory or spilled to a file. They are immutable; copies share them.
class KeyframePoints {
 public:
  using Points = std::vector<KeyframePoint>;
  KeyframePoints() = default;
  KeyframePoints(Points points)  // a list of points is one by itself
      : points_(std::make_shared<const Points>(std::move(points))), size_(points_->size()) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// The points, for reading. If they are spilled, each call reads them from the file and unpacks them. Empty if
  /// the file cannot be read. Never null.
  [[nodiscard]] std::shared_ptr<const Points> read() const;
  /// A copy that holds the points as read() gives them, for repeated access.
  [[nodiscard]] KeyframePoints in_memory() const;
  /// Spills the points to the file. Does nothing if they are spilled already, or if there are none.
  void spill(SpillFile& file);
  [[nodiscard]] bool is_spilled() const { return !spilled_.empty(); }
  /// Spilled, and in memory in no form.
  [[nodiscard]] bool is_in_file() const { return spilled_.is_in_file(); }
  bool operator==(const KeyframePoints& other) const { return size_ == other.size_ && *read() == *other.read(); }

 private:
  std::shared_ptr<const Points> points_;  // null: none, or spilled
  SpillFile::Values spilled_;
  std::size_t size_ = 0;
};

/// A keyframe of the drive: one downsampled scan and its pose. Whatever is rebuilt (the map for registration after a
/// loop closure, after a rollback, or from a saved map) is rebuilt from keyframes. The pose graph moves them.
struct Keyframe {
  std::int64_t utime = 0;  ///< us, end of its scan
  Pose T_map_base = Pose::Identity();
  KeyframePoints points;  ///< de-skewed, in base_link
};

}  // namespace curbstone::mapper::scan
