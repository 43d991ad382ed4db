#pragma once

#include <array>
#include <bitset>
#include <vector>

#include "services/semantic_map/cells/cell_columns.hpp"

namespace curbstone::semantic_map::cells {

/// Cells of the centre tile that belong to something as large as a vehicle and no larger: what stands there (its low
/// bonnet as its roof), and the ground inside its outline. Light gets under a vehicle, so that ground is seen where the
/// roof is not; nobody can drive there. Looks at the 9 m around.
struct VehicleCells {
  std::bitset<tile::kCellsInTile> beneath;  ///< see VehicleOutline; what stands is included
};
[[nodiscard]] VehicleCells find_vehicles(const tile::Around<CellColumns>& columns);

/// All that vehicles follow from: of each tile around, what stands in it and what is high.
using StandingAround = std::array<std::bitset<tile::kCellsInTile>, 18>;

/// find_vehicles() for a caller that asks for the same tiles again and again: most often nothing has come to stand in a
/// tile or about it since, and the vehicles of then are those of now. A value type; one thread.
class VehicleMemo {
 public:
  /// The same as find_vehicles().
  [[nodiscard]] VehicleCells find(const tile::Around<CellColumns>& columns);

 private:
  struct Found {
    bool is_known = false;
    StandingAround around;
    VehicleCells vehicles;
  };
  std::vector<Found> found_ = std::vector<Found>(256);  // 1.6 kB each; tiles with vehicles in sight are fewer
};

}  // namespace curbstone::semantic_map::cells
