#include "services/semantic_map/layers/tile_layers.hpp"

#include "common/tiles/vector_memory.hpp"
#include "services/semantic_map/tile/voted_tile_packing.hpp"

namespace curbstone::semantic_map::layers {

void SleepingLayers::sleep() {
  if (!awake_) return;
  ValuePacker packer;
  tile::pack(awake_->voted, packer);
  packer.put_all(std::span<const ground::GroundSample>(awake_->samples.cells));
  const cells::CellColumns& columns = awake_->columns;
  packer.put_all(std::span<const cells::CellColumn>(columns.cells));
  packer.put(columns.standing);
  packer.put(columns.blocked);
  packer.put(columns.high);
  packer.put(columns.ground);
  packer.put(awake_->paint.cells);
  packed_ = packer.pack();
  awake_.reset();
}

void SleepingLayers::wake() {
  if (awake_) return;
  ValueUnpacker unpacker(packed_);
  auto layers = std::make_unique<TileLayers>();
  layers->voted = tile::unpack_voted_tile(unpacker);
  unpacker.take_all(std::span<ground::GroundSample>(layers->samples.cells));
  cells::CellColumns& columns = layers->columns;
  unpacker.take_all(std::span<cells::CellColumn>(columns.cells));
  columns.standing = unpacker.take<decltype(columns.standing)>();
  columns.blocked = unpacker.take<decltype(columns.blocked)>();
  columns.high = unpacker.take<decltype(columns.high)>();
  columns.ground = unpacker.take<cells::Extent>();
  unpacker.take(layers->paint.cells);
  awake_ = std::move(layers);
  give_back(packed_);
}

}  // namespace curbstone::semantic_map::layers
