#pragma once

#include <Eigen/Core>
#include <vector>

namespace curbstone::mapper::place_recognition {

/// The lowest point of each square metre about the origin: the ground, where it is seen. Any levelled frame. Pure.
class LowestPoints {
 public:
  /// `reach`: m either way of the origin in x and y; what is beyond is not kept.
  explicit LowestPoints(float reach);

  void add(const Eigen::Vector3f& point);
  /// Of the point's own square metre; NaN where nothing was seen.
  [[nodiscard]] float at(const Eigen::Vector3f& point) const;
  /// Whether it stands clear of what is lowest in its own square metre and the eight around: a wall, a tree, a pole, a
  /// car; not the ground, on a slope neither.
  [[nodiscard]] bool upright(const Eigen::Vector3f& point) const;

 private:
  [[nodiscard]] int cell(float v) const;  // -1 beyond the reach
  int side_;
  float reach_;
  std::vector<float> lowest_;
};

/// The points that stand upright: see LowestPoints.
[[nodiscard]] std::vector<Eigen::Vector3f> upright(const std::vector<Eigen::Vector3f>& points,
                                                   const LowestPoints& lowest);

}  // namespace curbstone::mapper::place_recognition
