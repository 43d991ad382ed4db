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

/// The points of a kept scan, which may be put away, out of memory. They do not change, and copies share them.
class KeyframePoints {
 public:
  using Points = std::vector<KeyframePoint>;
  KeyframePoints() = default;
  KeyframePoints(Points points)  // NOLINT(google-explicit-constructor): they are what it is
      : here_(std::make_shared<const Points>(std::move(points))), size_(here_->size()) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// To look at. Of points that are away they are read from the file and unpacked, anew with each call. None if the
  /// file does not give them back. Never null.
  [[nodiscard]] std::shared_ptr<const Points> read() const;
  /// As read() gives them: for several looks.
  [[nodiscard]] KeyframePoints in_memory() const;
  /// Nothing if they are away, or none.
  void put_away(SpillFile& file);
  [[nodiscard]] bool is_away() const { return !away_.empty(); }
  /// Away, and not in memory in any form.
  [[nodiscard]] bool is_in_file() const { return away_.is_in_file(); }
  bool operator==(const KeyframePoints& other) const { return size_ == other.size_ && *read() == *other.read(); }

 private:
  std::shared_ptr<const Points> here_;  // null: none, or away
  SpillFile::Values away_;
  std::size_t size_ = 0;
};

/// A place on the drive from which the surroundings are remembered: one thinned scan and where it was taken.
/// Whatever must be built anew (the map for registration after a loop was closed, after a rollback, from a saved map)
/// is built from these; the pose graph moves them.
struct Keyframe {
  std::int64_t utime = 0;  ///< us, end of its scan
  Pose T_map_base = Pose::Identity();
  KeyframePoints points;  ///< de-skewed, in base_link
};

}  // namespace curbstone::mapper::scan
