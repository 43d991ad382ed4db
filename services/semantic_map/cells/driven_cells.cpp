#include "services/semantic_map/cells/driven_cells.hpp"

#include <cmath>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/cells/interpolated_road.hpp"

namespace curbstone::semantic_map::cells {

std::map<TileKey, CellBits> cells_beneath(const Pose& T_map_base, const VehicleConfig& vehicle) {
  std::map<TileKey, CellBits> tiles;
  const Eigen::Vector2d middle = (T_map_base * Eigen::Vector3d(vehicle.middle, 0, 0)).head<2>();
  if (!tile_at(middle.x(), middle.y())) return tiles;
  const Eigen::Vector2d ahead = T_map_base.linear().col(0).head<2>().normalized();
  const double reach = 0.5 * std::hypot(vehicle.length, vehicle.width);
  const Eigen::Array2d first = ((middle.array() - reach) / kCellSize).floor();
  const Eigen::Array2d last = ((middle.array() + reach) / kCellSize).floor();
  for (double y = first.y(); y <= last.y(); ++y) {
    for (double x = first.x(); x <= last.x(); ++x) {
      const Eigen::Vector2d centre = Eigen::Vector2d(x + 0.5, y + 0.5) * kCellSize;
      const Eigen::Vector2d d = centre - middle;
      const double beside = ahead.x() * d.y() - ahead.y() * d.x();
      if (std::abs(ahead.dot(d)) > 0.5 * vehicle.length || std::abs(beside) > 0.5 * vehicle.width) continue;
      const auto key = tile_at(centre.x(), centre.y());
      if (!key) continue;
      const auto column = static_cast<int>(x - static_cast<double>(key->x) * kCellsPerTile);
      const auto row = static_cast<int>(y - static_cast<double>(key->y) * kCellsPerTile);
      tiles[*key].set(static_cast<std::size_t>(row * kCellsPerTile + column));
    }
  }
  return tiles;
}

void add_driven_road(const CellColumns& columns, const CellBits& driven, const VehicleCells& vehicles,
                     const ground::GroundSurface& ground, tile::MapTile& tile) {
  for (std::size_t i = driven._Find_first(); i < tile::kCellsInTile; i = driven._Find_next(i)) {
    if (tile.cell_class[i] != tile::CellClass::kUnknown || !columns.cells[i].is_clear() || vehicles.beneath[i])
      continue;
    const double x = (static_cast<int>(i) % kCellsPerTile + 0.5) * kCellSize;
    const double y = (static_cast<int>(i) / kCellsPerTile + 0.5) * kCellSize;
    make_interpolated_road(tile, i, ground.height_or_rough(x, y));
  }
}

}  // namespace curbstone::semantic_map::cells
