#include "tools/simulate/world/scene.hpp"

#include <cmath>
#include <utility>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::world {

Scene::Scene(Ground ground, std::vector<Shape> shapes) : ground_(std::move(ground)), shapes_(std::move(shapes)) {
  const double pitch = Ground::kPitch;
  columns_ = static_cast<int>(std::ceil((ground_.width() - 1) * pitch / static_cast<double>(kCellSize))) + 1;
  rows_ = static_cast<int>(std::ceil((ground_.height() - 1) * pitch / static_cast<double>(kCellSize))) + 1;
  cells_.resize(static_cast<std::size_t>(columns_ * rows_));
  std::vector<std::vector<std::uint32_t>> lists(cells_.size());
  const auto x0 = static_cast<float>(ground_.x_of(0)), y0 = static_cast<float>(ground_.y_of(0));
  for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
    const Shape& shape = shapes_[i];
    const float c = std::abs(shape.cos_yaw), s = std::abs(shape.sin_yaw);
    const float ex = c * shape.half.x() + s * shape.half.y(), ey = s * shape.half.x() + c * shape.half.y();
    const auto column = [&](float x) { return std::clamp(static_cast<int>((x - x0) / kCellSize), 0, columns_ - 1); };
    const auto row = [&](float y) { return std::clamp(static_cast<int>((y - y0) / kCellSize), 0, rows_ - 1); };
    for (int iy = row(shape.centre.y() - ey); iy <= row(shape.centre.y() + ey); ++iy) {
      for (int ix = column(shape.centre.x() - ex); ix <= column(shape.centre.x() + ex); ++ix) {
        const float mx = x0 + (static_cast<float>(ix) + 0.5F) * kCellSize,
                    my = y0 + (static_cast<float>(iy) + 0.5F) * kCellSize;
        if (!shape.covers(mx, my, 1.5F)) continue;  // half the diagonal of a cell, plus a margin
        const auto index = static_cast<std::size_t>(iy * columns_ + ix);
        lists[index].push_back(i);
        cells_[index].bottom = std::min(cells_[index].bottom, shape.bottom());
        cells_[index].top = std::max(cells_[index].top, shape.top());
      }
    }
  }
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    cells_[k].first = static_cast<std::uint32_t>(members_.size());
    cells_[k].count = static_cast<std::uint32_t>(lists[k].size());
    members_.insert(members_.end(), lists[k].begin(), lists[k].end());
  }
}

Hit Scene::cast(const Ray& ray, float reach, std::span<const Shape> moving, std::uint64_t noise) const {
  Hit hit;
  hit.range = reach;
  cast_shapes(ray, noise, hit);
  cast_ground(ray, hit);  // last, because it is the most expensive and the hit on a shape bounds its range
  for (const Shape& shape : moving) {
    const Eigen::Vector3f to = shape.centre - ray.origin;
    const float along = to.dot(ray.direction);
    if (along > 0 && along - shape.radius() - 1.0F < hit.range &&
        to.squaredNorm() - along * along < shape.half.squaredNorm())
      intersect(shape, ray, noise, hit);
  }
  return hit;
}

void Scene::cast_ground(const Ray& ray, Hit& hit) const {
  const float horizontal = std::hypot(ray.direction.x(), ray.direction.y());
  if (horizontal < 1e-6F) return;
  const float dx = ray.direction.x() / horizontal, dy = ray.direction.y() / horizontal;
  const float u = ground_.cast(ray.origin.x(), ray.origin.y(), ray.origin.z(), dx, dy, ray.direction.z() / horizontal,
                               hit.range * horizontal);
  if (u < 0) return;
  const float x = ray.origin.x() + u * dx, y = ray.origin.y() + u * dy;
  const GroundVertex node = ground_.at(x, y);
  constexpr float kStep = 0.02F;
  const float h = ground_.height_of(node);
  const Eigen::Vector3f normal = Eigen::Vector3f((h - ground_.height_at(x + kStep, y)) / kStep,
                                                 (h - ground_.height_at(x, y + kStep)) / kStep, 1.0F)
                                     .normalized();
  const Surface surface = ground_.surface_of(node);
  hit = {u / horizontal, std::abs(normal.dot(ray.direction)), ground_reflectivity(surface), surface};
}

void Scene::cast_shapes(const Ray& ray, std::uint64_t noise, Hit& hit) const {
  // Amanatides and Woo: visits the cells that the ray crosses, nearest first.
  const float x = (ray.origin.x() - static_cast<float>(ground_.x_of(0))) / kCellSize;
  const float y = (ray.origin.y() - static_cast<float>(ground_.y_of(0))) / kCellSize;
  const float dx = ray.direction.x() / kCellSize, dy = ray.direction.y() / kCellSize;
  int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const int sx = dx > 0 ? 1 : -1, sy = dy > 0 ? 1 : -1;
  constexpr float kNever = 1e9F;
  const float px = std::abs(dx) > 1e-9F ? std::abs(1.0F / dx) : kNever;
  const float py = std::abs(dy) > 1e-9F ? std::abs(1.0F / dy) : kNever;
  float next_x = px == kNever ? kNever : (dx > 0 ? std::floor(x) + 1.0F - x : x - std::floor(x)) * px;
  float next_y = py == kNever ? kNever : (dy > 0 ? std::floor(y) + 1.0F - y : y - std::floor(y)) * py;
  float t = 0.0F;
  std::uint32_t last = 0xffffffffU;
  while (ix >= 0 && iy >= 0 && ix < columns_ && iy < rows_ && t < hit.range) {
    const float leave = std::min(next_x, next_y);
    const Cell& cell = cells_[static_cast<std::size_t>(iy * columns_ + ix)];
    if (cell.count > 0) {
      const float z0 = ray.origin.z() + t * ray.direction.z(), z1 = ray.origin.z() + leave * ray.direction.z();
      if (std::min(z0, z1) <= cell.top && std::max(z0, z1) >= cell.bottom) {
        for (std::uint32_t k = 0; k < cell.count; ++k) {
          const std::uint32_t i = members_[cell.first + k];
          if (i == last) continue;
          last = i;
          intersect(shapes_[i], ray, numerics::mix_bits(noise ^ i), hit);
        }
      }
    }
    t = leave;
    if (next_x < next_y) {
      ix += sx;
      next_x += px;
    } else {
      iy += sy;
      next_y += py;
    }
  }
}

float ground_reflectivity(Surface surface) {
  switch (surface) {
    case Surface::kAsphalt:
      return 0.14F;
    case Surface::kCurbStone:
      return 0.38F;
    case Surface::kPavement:
      return 0.26F;
    case Surface::kGrass:
      return 0.32F;
    default:
      return 0.3F;
  }
}

}  // namespace curbstone::simulate::world
