#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace curbstone::simulate::paint {

/// A brighter or darker part of a road: a band around a polyline. Frame: world, plan view, m.
struct Stroke {
  std::vector<Eigen::Vector2f> centre;
  float width = 0.12F;
  float reflectivity = 0.5F;
  float holes = 0.0F;  ///< share that is worn through
};

/// Strokes in a spatial grid. A later one covers an earlier one. Immutable once filled; then safe from any thread.
class Strokes {
 public:
  void add(const Stroke& stroke);

  /// Whether a stroke may be within half a metre.
  [[nodiscard]] bool near(float x, float y) const { return cells_.contains(key(x, y)); }
  /// Reflectivity of the topmost stroke at a place; `bare` if there is none.
  [[nodiscard]] float reflectivity(float x, float y, float bare) const;

 private:
  static constexpr float kCell = 1.0F;    // m
  static constexpr float kMargin = 0.5F;  // m around a stroke in which cells refer to it
  struct Segment {
    Eigen::Vector2f from, along;  // unit
    float length, half_width, reflectivity, holes;
  };
  [[nodiscard]] static std::int64_t key(float x, float y);

  std::vector<Segment> segments_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;  // in the order of adding
};

}  // namespace curbstone::simulate::paint
