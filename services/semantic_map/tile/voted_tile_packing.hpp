#pragma once

#include "common/packing/value_packer.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::tile {

/// Puts away a voted tile: positions as the whole steps that they were sent in.
void pack(const VotedTile& tile, ValuePacker& packer);
/// Every bit of it.
[[nodiscard]] VotedTile unpack_voted_tile(ValueUnpacker& unpacker);

}  // namespace curbstone::semantic_map::tile
