#pragma once

#include <bitset>

#include "services/semantic_map/cells/cell_columns.hpp"

namespace curbstone::semantic_map::cells {

/// Cells of the centre tile that belong to something as large as a vehicle and no larger: what stands there (its low
/// bonnet as its roof), and the ground inside its outline. Light gets under a vehicle, so that ground is seen where the
/// roof is not; nobody can drive there. Looks at the 9 m around.
struct VehicleCells {
  std::bitset<tile::kCellsInTile> beneath;  ///< see VehicleOutline; what stands is included
};
[[nodiscard]] VehicleCells find_vehicles(const tile::Around<CellColumns>& columns);

}  // namespace curbstone::semantic_map::cells
