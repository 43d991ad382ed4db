#pragma once

#include <cstdint>
#include <string>

#include "services/viewer/store/live_map.hpp"

namespace curbstone::viewer::foxglove {

/// Tiles along a side of the window around the vehicle: 60 m, 500 x 500 cells, 3 MB.
inline constexpr int kWindowTiles = 20;
/// Cells of the whole-map grid: 24 MB. A larger map gets larger cells.
inline constexpr std::int64_t kMaxWholeCells = 2'000'000;

/// Makes a foxglove.Grid in map, as protobuf. Each cell has red, green, blue and alpha by its class (the paper's Table
/// I; unknown is transparent), elevation (m in map, NaN: none), and class, cost and confidence as in semantic_tile_t. A
/// panel draws the grid flat, so the grid lies at the mean height of its road cells.
///
/// `middle`: the tile at the centre of the window. `utime`: us since the Unix epoch.
[[nodiscard]] std::string window_grid(const store::LiveMap& map, TileKey middle, std::int64_t utime);
/// The same of the whole map, in one message: a panel draws only the last grid of a topic. Where several cells are
/// merged into one, the highest-ranking class counts: curb, wall, obstacle, road. Empty if there is no map, or if it is
/// wider than 2^31 cells.
[[nodiscard]] std::string whole_grid(const store::LiveMap& map, std::int64_t utime);

}  // namespace curbstone::viewer::foxglove
