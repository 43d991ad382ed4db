#pragma once

#include <Eigen/Core>

#include "tools/simulate/world/ground.hpp"

namespace curbstone::simulate::world {

/// A ray in the world frame with a unit direction.
struct Ray {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;
};

/// The hit of a ray; there is none if `surface` is kNone.
struct Hit {
  float range = 1e9F;         ///< m
  float incidence = 1.0F;     ///< cosine of the angle between the ray and the surface's normal
  float reflectivity = 0.0F;  ///< 0..1, diffuse
  Surface surface = Surface::kNone;
};

/// The building blocks of a town: upright boxes, upright cylinders and ellipsoids.
struct Shape {
  enum class Kind : std::uint8_t { kBox, kCylinder, kEllipsoid };
  Kind kind = Kind::kBox;
  Surface surface = Surface::kWall;
  float reflectivity = 0.3F;
  Eigen::Vector3f centre;  ///< m
  Eigen::Vector3f half;    ///< m: half extents; a cylinder's radius is half.x
  float cos_yaw = 1.0F;
  float sin_yaw = 0.0F;

  [[nodiscard]] float bottom() const { return centre.z() - half.z(); }
  [[nodiscard]] float top() const { return centre.z() + half.z(); }
  /// m around the centre, seen from above
  [[nodiscard]] float radius() const {
    return kind == Kind::kBox ? std::hypot(half.x(), half.y()) : std::max(half.x(), half.y());
  }
  [[nodiscard]] bool covers(float x, float y, float margin = 0.0F) const;
};

[[nodiscard]] Shape make_box(Surface surface, float reflectivity, const Eigen::Vector3d& centre,
                             const Eigen::Vector3d& size, double yaw);
/// `base`: the centre of the bottom.
[[nodiscard]] Shape make_cylinder(Surface surface, float reflectivity, const Eigen::Vector3d& base, double radius,
                                  double height);
[[nodiscard]] Shape make_ellipsoid(Surface surface, float reflectivity, const Eigen::Vector3d& centre,
                                   const Eigen::Vector3d& half);

/// Shortens `hit` if the ray hits the shape at a smaller range. `noise` determines how deep this ray penetrates
/// foliage.
void intersect(const Shape& shape, const Ray& ray, std::uint64_t noise, Hit& hit);

}  // namespace curbstone::simulate::world
