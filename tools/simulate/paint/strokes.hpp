#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace curbstone::simulate::paint {

/// Something on a road that is brighter or darker than it: a band about a polyline. Frame: world, plan view, m.
struct Stroke {
  std::vector<Eigen::Vector2f> centre;
  float width = 0.12F;
  float reflectivity = 0.5F;
  float holes = 0.0F;  ///< share of it that is worn through
};

/// Strokes by where they are. What was added later lies on top. Immutable once filled; then safe from any thread.
class Strokes {
 public:
  void add(const Stroke& stroke);

  /// Whether a stroke may be within half a metre.
  [[nodiscard]] bool near(float x, float y) const { return cells_.contains(key(x, y)); }
  /// What is on top at a place; `bare` where nothing is.
  [[nodiscard]] float reflectivity(float x, float y, float bare) const;

 private:
  static constexpr float kCell = 1.0F;    // m
  static constexpr float kMargin = 0.5F;  // m about a stroke in which its cells know it
  struct Segment {
    Eigen::Vector2f from, along;  // unit
    float length, half_width, reflectivity, holes;
  };
  [[nodiscard]] static std::int64_t key(float x, float y);

  std::vector<Segment> segments_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;  // in the order of adding
};

}  // namespace curbstone::simulate::paint
