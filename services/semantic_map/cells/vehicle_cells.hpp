#pragma once

#include <array>
#include <bitset>
#include <unordered_map>

#include "common/tiles/tile.hpp"
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

/// Caches find_vehicles() for a caller that asks for the same tiles repeatedly: often nothing that stands in or around
/// a tile has changed, and the result is the same. A value type; one thread.
class VehicleCache {
 public:
  /// The same as find_vehicles(). `key`: of the centre tile.
  [[nodiscard]] VehicleCells find(TileKey key, const tile::Around<CellColumns>& columns);

 private:
  struct Found {
    StandingAround around;
    VehicleCells vehicles;
  };
  std::unordered_map<TileKey, Found, TileKeyHash> found_;  // of kMaxTiles at most
};

}  // namespace curbstone::semantic_map::cells
