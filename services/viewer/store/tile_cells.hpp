#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <curbstone/semantic_tile_t.hpp>
#include <optional>

#include "common/tiles/tile.hpp"

namespace curbstone::viewer::store {

inline constexpr std::size_t kCellsInTile = std::size_t{kCellsPerTile} * kCellsPerTile;

/// What a page shows of one tile, as in semantic_tile_t: cell (column, row) is at index row * 25 + column; row 0 has
/// the lowest y.
struct TileCells {
  std::int64_t utime = 0;        ///< us, of the newest map points that its curbs include
  std::int64_t curbs_utime = 0;  ///< us, of those that its curbs know of
  std::int32_t revision = 0;
  float z_origin = 0;                                   ///< m in map
  std::array<std::uint8_t, kCellsInTile> cell_class{};  ///< semantic_tile_t's values
  std::array<std::int16_t, kCellsInTile> height{};      ///< 2 mm steps from z_origin; semantic_tile_t::NO_HEIGHT
  std::array<std::uint8_t, kCellsInTile> cost{};        ///< 0 free .. 254 lethal, 255 unknown
  std::array<std::uint8_t, kCellsInTile> confidence{};  ///< 0 .. 255

  bool operator==(const TileCells&) const = default;
};

/// Empty if a field is out of range.
[[nodiscard]] std::optional<TileCells> cells_of(const semantic_tile_t& message);

}  // namespace curbstone::viewer::store
