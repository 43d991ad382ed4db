#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::cells {

/// Makes an unknown cell road in which nothing was seen (MapTile::is_interpolated()). `z`: of the ground, m in map;
/// nothing if it is not known.
inline void make_interpolated_road(tile::MapTile& tile, std::size_t cell, std::optional<double> z) {
  constexpr double kMost = 32767;
  tile.cell_class[cell] = tile::CellClass::kRoad;
  tile.cost[cell] = 0;
  tile.confidence[cell] = 0;
  if (!z) return;
  const double steps = std::round((*z - double{tile.z_origin}) / kPositionStep);
  if (std::abs(steps) <= kMost) tile.height[cell] = static_cast<std::int16_t>(steps);
}

}  // namespace curbstone::semantic_map::cells
