#pragma once

#include <Eigen/Core>
#include <vector>

namespace curbstone::mapper::place_recognition {

/// How what one scan saw bears another out.
struct VisibilityCount {
  int agree = 0;     ///< points where the rays ended about there
  int conflict = 0;  ///< points that the rays went through
  VisibilityCount& operator+=(const VisibilityCount& other) {
    agree += other.agree;
    conflict += other.conflict;
    return *this;
  }
};

/// How far a scan saw, by direction: where its rays went on, nothing can stand. Pure.
class VisibilityCheck {
 public:
  /// Points in a frame whose origin is the lidar's.
  explicit VisibilityCheck(const std::vector<Eigen::Vector3f>& points);

  /// Points of something that stands, in the same frame. What is beyond what was seen, or where no ray went, says
  /// nothing.
  [[nodiscard]] VisibilityCount check(const std::vector<Eigen::Vector3f>& points) const;

 private:
  struct Extent {
    float nearest, farthest;  // m; 0 where no ray went
  };
  std::vector<Extent> extents_;
};

}  // namespace curbstone::mapper::place_recognition
