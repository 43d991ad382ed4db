#pragma once

#include <vector>

#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/cells/vehicle_cells.hpp"
#include "services/semantic_map/curbs/curb_filter.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::cells {

/// The paper's Table I: road where ground was seen (pavement is ground) or on both sides (interpolate_ground()), curb
/// where curb points lie, obstacle (lower than the vehicle), wall or vehicle (all of its outline: `vehicles` of
/// find_vehicles()), else unknown. What hangs above the vehicle does not block; where points stand about the edge of
/// two cells, both block. Fills everything of the tile but key, utime and z_origin, which must be set: heights are
/// relative to z_origin.
void classify_cells(const tile::Around<CellColumns>& columns, const tile::Around<std::vector<curbs::CurbPoint>>& curbs,
                    const VehicleCells& vehicles, const ClassParameters& parameters, tile::MapTile& tile);

/// Cost of a cell: 0 free .. 254 lethal, 255 unknown.
[[nodiscard]] std::uint8_t traversal_cost(tile::CellClass cell_class, double curb_height,
                                          const ClassParameters& parameters);

}  // namespace curbstone::semantic_map::cells
