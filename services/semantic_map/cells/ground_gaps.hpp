#pragma once

#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/cells/vehicle_cells.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::cells {

/// Closes the gaps between scan lines: an unknown cell becomes road if it lies between ground that was seen on both
/// sides, 0.6 m apart at most and at the same height, and nothing stands in between or beside it. Its height is
/// interpolated, its confidence 0 (MapTile::is_interpolated()). A LiDAR 1.8 m high that sees the ground 5.0 m and 5.6 m
/// away misses nothing higher than 0.19 m in between, and farther away less: an obstacle would have been seen.
///
/// `tile`: with the other classes, which stay.
void interpolate_ground(const tile::Around<CellColumns>& columns, const VehicleCells& vehicles, tile::MapTile& tile);

}  // namespace curbstone::semantic_map::cells
