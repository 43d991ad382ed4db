#pragma once

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::map_export {

/// The map has no known cell, or too many cells for one raster.
class MapGridError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The layers of a map in one rectangle around all known cells. Image order: row 0 has the highest y.
struct MapGrid {
  std::int64_t column0 = 0;  ///< of the left column, in cells from the map's origin
  std::int64_t row0 = 0;     ///< of the lowest row
  int columns = 0;
  int rows = 0;
  std::vector<semantic_map::tile::CellClass> cell_class;  ///< kUnknown where there is no tile
  std::vector<float> height;                              ///< m in map; NaN: unknown
  std::vector<std::uint8_t> cost;                         ///< as in MapTile: 255 unknown
  std::vector<std::uint8_t> confidence;                   ///< as in MapTile
  std::vector<std::uint8_t> hits;                         ///< as in MapTile
  [[nodiscard]] double left() const;                      ///< m in map, of the rectangle's edge
  [[nodiscard]] double top() const;
  [[nodiscard]] double bottom() const;
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
};

inline constexpr std::int64_t kMaxGridCells = 200'000'000;  ///< 1.7 km square; 1.6 GB

/// A cell is known if it has a class or a height. Throws MapGridError.
[[nodiscard]] MapGrid make_map_grid(const std::vector<semantic_map::tile::MapTile>& tiles);

/// Rise over run of the ground by Horn's method (Proc. IEEE 69, 1981) over 3 x 3 cells. NaN unless all nine are road or
/// curb: other cells may have the height of an object.
[[nodiscard]] std::vector<float> ground_slope(const MapGrid& grid);

}  // namespace curbstone::map_export
