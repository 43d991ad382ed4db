#pragma once

#include <bitset>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/cells/vehicle_outline.hpp"

namespace curbstone::semantic_map::cells {

/// What stands in the tiles around, is of the size of a vehicle and whose cell nearest to the middle of its extent is
/// in the centre tile; in cells from that tile's corner. So each vehicle belongs to one tile, which has points of it,
/// and which sees a vehicle of 5 to 6 m from end to end; of a longer one not more than its window of 9 m. Pure.
[[nodiscard]] std::vector<VehicleOutline> find_vehicles(const tile::Around<CellColumns>& columns);

/// Cells of the centre tile that belong to an object of the size of a vehicle: its points, of a low bonnet as of the
/// roof, and the ground inside its outline. Light gets under a vehicle, so ground may be seen within the outline, but
/// nobody can drive there.
struct VehicleCells {
  std::bitset<tile::kCellsInTile> beneath;  ///< see VehicleOutline; what stands is included
};
/// `vehicles`: of each tile around, from its own corner.
[[nodiscard]] VehicleCells cover_vehicles(const tile::Around<std::vector<VehicleOutline>>& vehicles);

}  // namespace curbstone::semantic_map::cells
