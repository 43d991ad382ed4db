#pragma once

#include "common/tiles/tile.hpp"
#include "services/viewer/frames/byte_writer.hpp"
#include "services/viewer/store/tile_cells.hpp"

namespace curbstone::viewer::frames {

/// Bytes of a tile record in form 0.
inline constexpr std::size_t kWholeTile = 33 + 5 * store::kCellsInTile;

/// Writes a tile record (README.md) of the whole tile.
void write_tile(ByteWriter& out, TileKey key, const store::TileCells& cells);
/// Writes a tile record of what changed since `before`, or of the whole tile where that is shorter.
void write_changes(ByteWriter& out, TileKey key, const store::TileCells& before, const store::TileCells& cells);

}  // namespace curbstone::viewer::frames
