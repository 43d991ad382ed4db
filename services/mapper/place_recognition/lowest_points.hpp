#pragma once

#include <Eigen/Core>
#include <vector>

namespace curbstone::mapper::place_recognition {

/// The lowest point of each square metre around the origin: the ground, where it is visible. Any levelled frame. Pure.
class LowestPoints {
 public:
  /// `reach`: m either way of the origin in x and y; points beyond are ignored.
  explicit LowestPoints(float reach);

  void add(const Eigen::Vector3f& point);
  /// Height of the lowest point in the point's own square metre; NaN if there is none.
  [[nodiscard]] float at(const Eigen::Vector3f& point) const;
  /// Whether the point is clear of the lowest points of its own square metre and of the eight around: a wall, a tree, a
  /// pole, a car. Ground is not upright, on a slope neither.
  [[nodiscard]] bool upright(const Eigen::Vector3f& point) const;

 private:
  [[nodiscard]] int cell(float v) const;  // -1 beyond the reach
  int side_;
  float reach_;
  std::vector<float> lowest_;
};

/// The upright points: see LowestPoints.
[[nodiscard]] std::vector<Eigen::Vector3f> upright(const std::vector<Eigen::Vector3f>& points,
                                                   const LowestPoints& lowest);

}  // namespace curbstone::mapper::place_recognition
