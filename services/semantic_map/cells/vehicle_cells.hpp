#pragma once

#include <array>
#include <bitset>
#include <vector>

#include "services/semantic_map/cells/cell_columns.hpp"

namespace curbstone::semantic_map::cells {

/// Cells of the centre tile that belong to an object of the size of a vehicle: its points, of a low bonnet as of the
/// roof, and the ground inside its outline. Light gets under a vehicle, so ground may be seen within the outline, but
/// nobody can drive there. Uses the 9 m around.
struct VehicleCells {
  std::bitset<tile::kCellsInTile> beneath;  ///< see VehicleOutline; what stands is included
};
[[nodiscard]] VehicleCells find_vehicles(const tile::Around<CellColumns>& columns);

/// The only inputs of find_vehicles(): for each tile around, the cells that are standing and those that are high.
using StandingAround = std::array<std::bitset<tile::kCellsInTile>, 18>;

/// Caches find_vehicles() for a caller that asks for the same tiles repeatedly: usually nothing in or around a tile has
/// changed, and the result is the same. A value type; one thread.
class VehicleCache {
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
