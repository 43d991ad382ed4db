#pragma once

#include <cstdint>
#include <string>

#include "services/viewer/store/live_map.hpp"

namespace curbstone::viewer::foxglove {

/// Tiles along a side of the window about the vehicle: 60 m, 500 x 500 cells, 3 MB.
inline constexpr int kWindowTiles = 20;
/// Of the whole map: 24 MB. A larger map has larger cells.
inline constexpr std::int64_t kMaxWholeCells = 2'000'000;

/// A foxglove.Grid in map, as protobuf. Of a cell: red, green, blue, alpha by its class (the paper's Table I; unknown
/// is transparent), elevation (m in map, NaN: none), class, cost, confidence as in semantic_tile_t. A panel draws it
/// flat, so it lies at the mean height of its road.
///
/// `middle`: the tile about which the window lies. `utime`: us since the Unix epoch.
[[nodiscard]] std::string window_grid(const store::LiveMap& map, TileKey middle, std::int64_t utime);
/// Everything; a panel draws a topic's last grid alone, so there are no pieces. Where cells are put together the one
/// that tells most counts: curb, wall, obstacle, road. Empty text: there is no map, or it is wider than 2^31 cells.
[[nodiscard]] std::string whole_grid(const store::LiveMap& map, std::int64_t utime);

}  // namespace curbstone::viewer::foxglove
