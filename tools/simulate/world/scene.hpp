#pragma once

#include <span>
#include <vector>

#include "tools/simulate/world/ground.hpp"
#include "tools/simulate/world/shapes.hpp"

namespace curbstone::simulate::world {

/// All static objects, organised for ray casting: about a million rays per second. Immutable after building; cast() is
/// safe from any thread.
class Scene {
 public:
  Scene() = default;
  Scene(Ground ground, std::vector<Shape> shapes);

  /// The nearest hit of the ray within `reach` metres, including `moving` shapes. `noise`: random bits of this ray.
  [[nodiscard]] Hit cast(const Ray& ray, float reach, std::span<const Shape> moving, std::uint64_t noise) const;

  [[nodiscard]] const Ground& ground() const { return ground_; }
  [[nodiscard]] const std::vector<Shape>& shapes() const { return shapes_; }

 private:
  struct Cell {
    std::uint32_t first = 0;  ///< into members_
    std::uint32_t count = 0;
    float bottom = 1e9F;
    float top = -1e9F;
  };
  static constexpr float kCellSize = 2.0F;  ///< m

  void cast_shapes(const Ray& ray, std::uint64_t noise, Hit& hit) const;
  void cast_ground(const Ray& ray, Hit& hit) const;

  Ground ground_;
  std::vector<Shape> shapes_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> members_;
  int columns_ = 0;
  int rows_ = 0;
};

/// 0..1, diffuse, of the kinds of ground.
[[nodiscard]] float ground_reflectivity(Surface surface);

}  // namespace curbstone::simulate::world
