#pragma once

#include <bitset>

#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::cells {

/// The obstacle in a cell, with its neighbours considered: a point just beyond the edge may in fact be on this side of
/// it, and a single point counts if there are others beside it. Strays of what stands beside do not count where the
/// ground was seen: with time every wall has some.
struct Standing {
  bool blocks = false;
  double top = 0;  ///< m above ground
};

/// Of a cell of the centre tile. Pure.
[[nodiscard]] Standing standing_at(const tile::Around<CellColumns>& columns, int column, int row,
                                   const ClassParameters& parameters);

/// The cells of the centre tile with points above the ground, and their neighbours: nothing stands in the others.
[[nodiscard]] std::bitset<tile::kCellsInTile> find_near_standing(const tile::Around<CellColumns>& columns);

}  // namespace curbstone::semantic_map::cells
