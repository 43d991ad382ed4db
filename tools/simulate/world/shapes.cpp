#include "tools/simulate/world/shapes.hpp"

#include <cmath>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::world {

namespace {

struct Local {
  Eigen::Vector3f origin;
  Eigen::Vector3f direction;
};

Local to_local(const Shape& shape, const Ray& ray) {
  const Eigen::Vector3f o = ray.origin - shape.centre;
  const Eigen::Vector3f& d = ray.direction;
  const float c = shape.cos_yaw, s = shape.sin_yaw;
  return {{c * o.x() + s * o.y(), -s * o.x() + c * o.y(), o.z()},
          {c * d.x() + s * d.y(), -s * d.x() + c * d.y(), d.z()}};
}

void keep(const Shape& shape, float range, float incidence, Hit& hit) {
  hit = {range, incidence, shape.reflectivity, shape.surface};
}

void intersect_box(const Shape& shape, const Ray& ray, Hit& hit) {
  const Local local = to_local(shape, ray);
  float enter = 0.0F, leave = hit.range;
  int axis = -1;
  for (int i = 0; i < 3; ++i) {
    const float inverse = 1.0F / local.direction[i];  // infinity is fine: the slab test is then all or nothing
    float a = (-shape.half[i] - local.origin[i]) * inverse;
    float b = (shape.half[i] - local.origin[i]) * inverse;
    if (a > b) std::swap(a, b);
    if (a > enter) {
      enter = a;
      axis = i;
    }
    if (b < leave) leave = b;
    if (!(enter <= leave)) return;
  }
  if (axis >= 0) keep(shape, enter, std::abs(local.direction[axis]), hit);
}

void intersect_cylinder(const Shape& shape, const Ray& ray, Hit& hit) {
  const Eigen::Vector3f o = ray.origin - shape.centre;
  const Eigen::Vector3f& d = ray.direction;
  const float a = d.x() * d.x() + d.y() * d.y();
  const float b = o.x() * d.x() + o.y() * d.y();
  const float c = o.x() * o.x() + o.y() * o.y() - shape.half.x() * shape.half.x();
  const float discriminant = b * b - a * c;
  if (discriminant < 0 || a < 1e-9F) return;
  const float t = (-b - std::sqrt(discriminant)) / a;
  if (t <= 0 || t >= hit.range || std::abs(o.z() + t * d.z()) > shape.half.z()) return;
  const float nx = (o.x() + t * d.x()) / shape.half.x(), ny = (o.y() + t * d.y()) / shape.half.x();
  keep(shape, t, std::abs(nx * d.x() + ny * d.y()), hit);
}

void intersect_ellipsoid(const Shape& shape, const Ray& ray, std::uint64_t noise, Hit& hit) {
  const Eigen::Vector3f o = (ray.origin - shape.centre).cwiseQuotient(shape.half);
  const Eigen::Vector3f d = ray.direction.cwiseQuotient(shape.half);
  const float a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1.0F;
  const float discriminant = b * b - a * c;
  if (discriminant < 0) return;
  const float root = std::sqrt(discriminant);
  const float enter = (-b - root) / a, leave = (-b + root) / a;
  if (enter <= 0 || enter >= hit.range) return;
  // Foliage: a ray penetrates to a random depth, and may pass through.
  const float depth = -0.45F * std::log(1.0F - static_cast<float>(numerics::unit_from_bits(noise)));
  if (enter + depth > leave || enter + depth >= hit.range) return;
  keep(shape, enter + depth, 0.7F, hit);
}

}  // namespace

bool Shape::covers(float x, float y, float margin) const {
  const float dx = x - centre.x(), dy = y - centre.y();
  if (kind == Kind::kCylinder) return std::hypot(dx, dy) <= half.x() + margin;
  const float lx = std::abs(cos_yaw * dx + sin_yaw * dy), ly = std::abs(-sin_yaw * dx + cos_yaw * dy);
  if (kind == Kind::kEllipsoid) return std::hypot(dx / (half.x() + margin), dy / (half.y() + margin)) <= 1.0F;
  return lx <= half.x() + margin && ly <= half.y() + margin;
}

Shape make_box(Surface surface, float reflectivity, const Eigen::Vector3d& centre, const Eigen::Vector3d& size,
               double yaw) {
  return {Shape::Kind::kBox,
          surface,
          reflectivity,
          centre.cast<float>(),
          (0.5 * size).cast<float>(),
          static_cast<float>(std::cos(yaw)),
          static_cast<float>(std::sin(yaw))};
}

Shape make_cylinder(Surface surface, float reflectivity, const Eigen::Vector3d& base, double radius, double height) {
  const Eigen::Vector3d half(radius, radius, 0.5 * height);
  return {Shape::Kind::kCylinder, surface, reflectivity, (base + Eigen::Vector3d(0, 0, half.z())).cast<float>(),
          half.cast<float>(),     1.0F,    0.0F};
}

Shape make_ellipsoid(Surface surface, float reflectivity, const Eigen::Vector3d& centre, const Eigen::Vector3d& half) {
  return {Shape::Kind::kEllipsoid, surface, reflectivity, centre.cast<float>(), half.cast<float>(), 1.0F, 0.0F};
}

void intersect(const Shape& shape, const Ray& ray, std::uint64_t noise, Hit& hit) {
  switch (shape.kind) {
    case Shape::Kind::kBox:
      return intersect_box(shape, ray, hit);
    case Shape::Kind::kCylinder:
      return intersect_cylinder(shape, ray, hit);
    case Shape::Kind::kEllipsoid:
      return intersect_ellipsoid(shape, ray, noise, hit);
  }
}

}  // namespace curbstone::simulate::world
