#include "tests/services/localizer/yard.hpp"

#include <cmath>
#include <map>

namespace curbstone::localizer::test_yard {
namespace {

using semantic_map::tile::CellClass;
using semantic_map::tile::MapTile;

constexpr double kCurbHeight = 0.1;  // m

double ground_of(const Yard& yard, const Eigen::Vector2d& p) {
  return p.y() < yard.curb ? kCurbHeight : 0.0;
}

/// Plan of what stands, 2 cm apart, in the yard's axes.
std::vector<Eigen::Vector2d> standing_in(const Yard& yard) {
  std::vector<Eigen::Vector2d> plan;
  for (double x = -yard.half_length; x <= yard.half_length; x += 0.02) {
    plan.emplace_back(x, -yard.half_width);
    if (!yard.open || x > 0) plan.emplace_back(x, yard.half_width);
  }
  if (!yard.ends) return plan;
  for (double y = -yard.half_width; y <= yard.half_width; y += 0.02) {
    plan.emplace_back(yard.half_length, y);
    if (!yard.open) plan.emplace_back(-yard.half_length, y);
  }
  for (double a = 0; a < 6.28; a += 0.1) {
    const Eigen::Vector2d round(0.2 * std::cos(a), 0.2 * std::sin(a));
    plan.push_back(Eigen::Vector2d(4, 3) + round);
    plan.push_back(Eigen::Vector2d(-6, -5) + round);
  }
  return plan;
}

class TileWriter {
 public:
  MapTile& tile(const Eigen::Vector2d& p, std::size_t& cell) {
    const TileKey key = *tile_at(p.x(), p.y());
    const auto [it, fresh] = tiles_.try_emplace(key);
    if (fresh) {
      it->second.key = key;
      it->second.height.fill(MapTile::kNoHeight);
    }
    const auto column = static_cast<std::size_t>((p.x() - key.x * kTileSize) / kCellSize);
    const auto row = static_cast<std::size_t>((p.y() - key.y * kTileSize) / kCellSize);
    cell = std::min<std::size_t>(row, 24) * 25 + std::min<std::size_t>(column, 24);
    return it->second;
  }
  [[nodiscard]] std::vector<MapTile> take() const {
    std::vector<MapTile> all;
    for (const auto& [key, tile] : tiles_) all.push_back(tile);
    return all;
  }

 private:
  std::map<TileKey, MapTile> tiles_;
};

}  // namespace

std::vector<MapTile> map_of(const Yard& yard) {
  const Eigen::Rotation2Dd turn(yard.turned);
  TileWriter writer;
  std::size_t cell = 0;
  for (double x = -yard.half_length; x < yard.half_length; x += 0.03) {
    for (double y = -yard.half_width; y < yard.half_width; y += 0.03) {
      MapTile& tile = writer.tile(turn * Eigen::Vector2d(x, y), cell);
      const bool is_curb = std::abs(y - yard.curb) < kCellSize / 2;
      if (tile.cell_class[cell] != CellClass::kCurb)
        tile.cell_class[cell] = is_curb ? CellClass::kCurb : CellClass::kRoad;
      tile.height[cell] = static_cast<std::int16_t>(std::lround(ground_of(yard, {x, y}) / kPositionStep));
      tile.hits[cell] = 3;
      tile.confidence[cell] = 96;
    }
  }
  for (const Eigen::Vector2d& p : standing_in(yard)) {
    MapTile& tile = writer.tile(turn * p, cell);
    const bool fresh = tile.cell_class[cell] != CellClass::kWall;
    tile.cell_class[cell] = CellClass::kWall;
    tile.hits[cell] = static_cast<std::uint8_t>(fresh ? 2 : std::min(200, tile.hits[cell] + 2));
  }
  return writer.take();
}

std::vector<MapTile> twice(std::vector<MapTile> tiles, int on) {
  const std::vector<MapTile> once = tiles;
  for (MapTile tile : once) {
    tile.key.x += on;
    tiles.push_back(tile);
  }
  return tiles;
}

std::vector<Eigen::Vector3d> points_in(const Yard& yard, const Pose& T_map_base) {
  const Eigen::Rotation2Dd turn(yard.turned);
  const Pose T_base_map = T_map_base.inverse();
  std::vector<Eigen::Vector3d> points;
  const auto add = [&](const Eigen::Vector2d& p, double z) {
    const Eigen::Vector2d q = turn * p;
    points.push_back(T_base_map * Eigen::Vector3d(q.x(), q.y(), z));
  };
  for (double x = -yard.half_length + 0.3; x < yard.half_length - 0.3; x += 0.17) {
    for (double y = -yard.half_width + 0.3; y < yard.half_width - 0.3; y += 0.17) add({x, y}, ground_of(yard, {x, y}));
  }
  int i = 0;
  for (const Eigen::Vector2d& p : standing_in(yard)) {
    if (++i % 5 == 0) add(p, ground_of(yard, p) + 0.6 + 0.2 * (i % 5));
  }
  return points;
}

Pose pose_at(double x, double y, double yaw) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, 0);
  pose.linear() = rotation_from_rpy(0, 0, yaw);
  return pose;
}

}  // namespace curbstone::localizer::test_yard
