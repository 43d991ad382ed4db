#pragma once

#include <cstdint>
#include <vector>

#include "services/mapper/dense_map/dense_map.hpp"
#include "tests/stamps.hpp"

namespace curbstone::mapper::dense_map {

using test::kStart;
inline constexpr std::int64_t kPeriod = 50'000;

/// Ground in a patch around (x, y), as points in base_link, one in the middle of each voxel; the vehicle is at the
/// origin of the map.
inline std::vector<scan::LidarPoint> patch(double x, double y, double z, double size = 1.0, double step = 0.05) {
  std::vector<scan::LidarPoint> points;
  for (double dx = 0.025 - size / 2; dx < size / 2; dx += step) {
    for (double dy = 0.025 - size / 2; dy < size / 2; dy += step) {
      points.push_back({Eigen::Vector3d(x + dx, y + dy, z).cast<float>(), 0, 100, 0});
    }
  }
  return points;
}

/// Of the tiles about the origin, m, map.
inline std::vector<Eigen::Vector3d> all_points(const DenseMap& map) {
  std::vector<Eigen::Vector3d> out;
  for (int x = -10; x < 10; ++x) {
    for (int y = -10; y < 10; ++y) {
      const DenseTile* tile = map.tile({x, y});
      if (tile == nullptr) continue;
      for (const TilePoint& p : tile->read()->points()) {
        out.emplace_back(x * kTileSize + p.x * kPositionStep, y * kTileSize + p.y * kPositionStep,
                         tile->z_origin() + p.z * kPositionStep);
      }
    }
  }
  return out;
}

}  // namespace curbstone::mapper::dense_map
