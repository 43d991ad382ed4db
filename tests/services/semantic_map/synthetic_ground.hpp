#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <vector>

#include "tools/detect/cloud_map/cloud_map.hpp"

namespace curbstone::semantic_map {

/// Clouds of surfaces as a mapped street has them: even density, noise along z as a LiDAR's.
class SyntheticCloud {
 public:
  explicit SyntheticCloud(unsigned seed = 1, double noise = 0.01) : random_(seed), noise_(0, noise) {}

  /// z = height(x, y) over a rectangle, `density` points a square metre.
  void ground(double x0, double y0, double x1, double y1, double density,
              const std::function<double(double, double)>& height) {
    const auto n = static_cast<int>((x1 - x0) * (y1 - y0) * density);
    for (int i = 0; i < n; ++i) {
      const double x = uniform(x0, x1);
      const double y = uniform(y0, y1);
      add(x, y, height(x, y));
    }
  }
  /// A vertical face over the segment (x0, y0) - (x1, y1), from z0 to z1.
  void face(double x0, double y0, double x1, double y1, double z0, double z1, double density) {
    const auto n = static_cast<int>(std::hypot(x1 - x0, y1 - y0) * (z1 - z0) * density);
    for (int i = 0; i < n; ++i) {
      const double s = uniform(0, 1);
      add(x0 + s * (x1 - x0), y0 + s * (y1 - y0), uniform(z0, z1));
    }
  }
  /// A box on the ground: roof and sides.
  void box(double x0, double y0, double x1, double y1, double z0, double z1, double density) {
    ground(x0, y0, x1, y1, density, [=](double, double) { return z1; });
    face(x0, y0, x1, y0, z0, z1, density);
    face(x1, y0, x1, y1, z0, z1, density);
    face(x1, y1, x0, y1, z0, z1, density);
    face(x0, y1, x0, y0, z0, z1, density);
  }
  void add(double x, double y, double z) {
    points.emplace_back(static_cast<float>(x + noise_(random_)), static_cast<float>(y + noise_(random_)),
                        static_cast<float>(z + noise_(random_)));
  }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  std::vector<Eigen::Vector3f> points;

 private:
  std::mt19937 random_;
  std::normal_distribution<double> noise_;
};

inline detect::cloud_map::CloudMap map_of(const SyntheticCloud& cloud,
                                          detect::cloud_map::CloudMapOptions options = {}) {
  options.threads = 1;
  return detect::cloud_map::map_cloud(cloud.points, options);
}

/// The class of the cell at (x, y).
inline tile::CellClass class_at(const detect::cloud_map::CloudMap& map, double x, double y) {
  const TileKey key = *tile_at(x, y);
  for (const tile::MapTile& tile : map.tiles) {
    if (tile.key != key) continue;
    const int column = static_cast<int>((x - key.x * kTileSize) / kCellSize);
    const int row = static_cast<int>((y - key.y * kTileSize) / kCellSize);
    return tile.cell_class[static_cast<std::size_t>(row * kCellsPerTile + column)];
  }
  return tile::CellClass::kUnknown;
}

}  // namespace curbstone::semantic_map
