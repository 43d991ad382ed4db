#pragma once

#include <bitset>
#include <map>

#include "common/config/vehicle.hpp"
#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/cells/vehicle_cells.hpp"
#include "services/semantic_map/ground/ground_model.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::cells {

/// Cells of a tile, a bit each.
using CellBits = std::bitset<tile::kCellsInTile>;

/// The cells whose centres the vehicle covers, of each tile that it touches.
[[nodiscard]] std::map<TileKey, CellBits> cells_beneath(const Pose& T_map_base, const VehicleConfig& vehicle);

/// What was driven over is road, though no beam has hit it: near the start, a LiDAR on the roof has never seen the
/// ground beneath the vehicle. Makes unknown cells of `driven` road, as interpolate_ground() does, at the height of the
/// ground model. `tile`: with the other classes, which stay.
void add_driven_road(const CellColumns& columns, const CellBits& driven, const VehicleCells& vehicles,
                     const ground::GroundSurface& ground, tile::MapTile& tile);

}  // namespace curbstone::semantic_map::cells
