#pragma once

#include "common/packing/value_packer.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::tile {

/// Packs a voted tile: positions as the integer steps in which they were sent.
void pack(const VotedTile& tile, ValuePacker& packer);
/// Restores the tile bit-identical.
[[nodiscard]] VotedTile unpack_voted_tile(ValueUnpacker& unpacker);

}  // namespace curbstone::semantic_map::tile
