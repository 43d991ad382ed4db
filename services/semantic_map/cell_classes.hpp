#pragma once

#include <vector>

#include "services/semantic_map/cell_columns.hpp"
#include "services/semantic_map/curb_filter.hpp"
#include "services/semantic_map/map_types.hpp"

namespace curbstone {

/// The paper's Table I: road where ground was seen (pavement is ground), curb where curb points lie, obstacle (lower
/// than the vehicle), wall or vehicle (all of its outline, find_vehicles()), else unknown. What hangs above the vehicle
/// does not block; where points stand about the edge of two cells, both block. Fills everything of the tile but key,
/// utime and z_origin, which must be set: heights are relative to z_origin.
void classify_cells(const Around<CellColumns>& columns, const Around<std::vector<CurbPoint>>& curbs,
                    const ClassParameters& parameters, MapTile& tile);

/// 0 free .. 254 lethal, 255 unknown.
[[nodiscard]] std::uint8_t traversal_cost(CellClass cell_class, double curb_height, const ClassParameters& parameters);

}  // namespace curbstone
