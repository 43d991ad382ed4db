#pragma once

#include <Eigen/Core>
#include <vector>

namespace curbstone::mapper::place_recognition {

/// How far a scan confirms or contradicts points.
struct VisibilityCount {
  int agree = 0;     ///< points near which the rays ended
  int conflict = 0;  ///< points that the rays passed through
  VisibilityCount& operator+=(const VisibilityCount& other) {
    agree += other.agree;
    conflict += other.conflict;
    return *this;
  }
};

/// The free space that a scan shows: its range by direction. Nothing can stand where its rays passed. Pure.
class VisibilityCheck {
 public:
  /// `points` in a frame whose origin is the lidar.
  explicit VisibilityCheck(const std::vector<Eigen::Vector3f>& points);

  /// Checks points of upright objects, in the same frame. Points beyond the observed range, or where no ray went, are
  /// not counted.
  [[nodiscard]] VisibilityCount check(const std::vector<Eigen::Vector3f>& points) const;

 private:
  struct Extent {
    float nearest, farthest;  // m; 0 where no ray went
  };
  std::vector<Extent> extents_;
};

}  // namespace curbstone::mapper::place_recognition
