#include "tools/simulate/truth/class_grid.hpp"

#include <algorithm>
#include <cmath>
#include <curbstone/semantic_tile_t.hpp>

#include "tools/simulate/truth/curb_lines.hpp"

namespace curbstone::simulate::truth {

namespace {

constexpr double kSampleApart = 0.02;    // m; close enough not to miss a curb's face
constexpr float kObstacleHeight = 1.2F;  // m
constexpr float kBehind = 12.0F;         // m behind a curb; gardens beyond have no truth

std::uint8_t ground_class(const world::Ground& ground, double x, double y, double size) {
  const world::GroundVertex middle = ground.at(static_cast<float>(x + 0.5 * size), static_cast<float>(y + 0.5 * size));
  if (middle.distance > kBehind) return semantic_tile_t::UNKNOWN;
  if (std::abs(middle.distance) < 0.3F) {
    const int samples = static_cast<int>(std::ceil(size / kSampleApart - 1e-9));  // along one side of a cell
    for (int i = 0; i < samples * samples; ++i) {
      const double sx = x + size * ((i % samples) + 0.5) / samples, sy = y + size * ((i / samples) + 0.5) / samples;
      const world::GroundVertex node = ground.at(static_cast<float>(sx), static_cast<float>(sy));
      if (node.distance < 0 || node.distance > static_cast<float>(ground.profile().face)) continue;
      return node.curb < static_cast<float>(kDroppedBelow) ? semantic_tile_t::UNKNOWN : semantic_tile_t::CURB;
    }
  }
  return semantic_tile_t::ROAD;
}

}  // namespace

double fine_resolution(const world::Scene& scene) {
  constexpr double kFinest = 0.03;    // m
  constexpr double kMaxPixels = 1e8;  // a town of 300 m x 300 m
  const world::Ground& ground = scene.ground();
  const double area = ground.width() * world::Ground::kPitch * ground.height() * world::Ground::kPitch;
  return area > kFinest * kFinest * kMaxPixels ? ClassGrid{}.resolution : kFinest;
}

ClassGrid make_class_grid(const world::Scene& scene, double vehicle_height, double resolution) {
  const world::Ground& ground = scene.ground();
  ClassGrid grid;
  grid.resolution = resolution;
  grid.x0 = ground.x_of(0);
  grid.y0 = ground.y_of(0);
  const double size = grid.resolution;
  const auto cells = [&](double length) { return static_cast<int>(length / size); };
  grid.image = GrayImage(cells((ground.width() - 1) * world::Ground::kPitch),
                         cells((ground.height() - 1) * world::Ground::kPitch));
  GrayImage& image = grid.image;
  const auto row_of = [&](int iy) { return image.height - 1 - iy; };
  for (int iy = 0; iy < image.height; ++iy) {
    for (int ix = 0; ix < image.width; ++ix)
      image.at(ix, row_of(iy)) = ground_class(ground, grid.x0 + ix * size, grid.y0 + iy * size, size);
  }
  for (const world::Shape& shape : scene.shapes()) {
    const float floor = ground.height_at(shape.centre.x(), shape.centre.y());
    if (shape.bottom() - floor > static_cast<float>(vehicle_height)) continue;
    const bool low = shape.surface != world::Surface::kCar && shape.top() - floor < kObstacleHeight;
    const std::uint8_t id = low ? semantic_tile_t::OBSTACLE : semantic_tile_t::WALL;
    const auto index = [&](float v, double origin) {
      return static_cast<int>(std::floor((static_cast<double>(v) - origin) / size));
    };
    const float r = shape.radius() + static_cast<float>(size);
    for (int iy = std::max(0, index(shape.centre.y() - r, grid.y0));
         iy <= std::min(image.height - 1, index(shape.centre.y() + r, grid.y0)); ++iy) {
      for (int ix = std::max(0, index(shape.centre.x() - r, grid.x0));
           ix <= std::min(image.width - 1, index(shape.centre.x() + r, grid.x0)); ++ix) {
        const auto x = static_cast<float>(grid.x0 + (ix + 0.5) * size),
                   y = static_cast<float>(grid.y0 + (iy + 0.5) * size);
        std::uint8_t& cell = image.at(ix, row_of(iy));
        if (shape.covers(x, y, 0.5F * static_cast<float>(size))) cell = std::max(cell, id);
      }
    }
  }
  return grid;
}

}  // namespace curbstone::simulate::truth
