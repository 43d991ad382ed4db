#include "services/semantic_map/layers/tile_layers.hpp"

#include <span>
#include <stdexcept>
#include <utility>

#include "services/semantic_map/tile/voted_tile_packing.hpp"

namespace curbstone::semantic_map::layers {

namespace {

PackedValues pack(const TileLayers& layers) {
  ValuePacker packer;
  tile::pack(layers.voted, packer);
  packer.put_all(std::span<const ground::GroundSample>(layers.samples.cells));
  const cells::CellColumns& columns = layers.columns;
  packer.put_all(std::span<const cells::CellColumn>(columns.cells));
  packer.put(columns.standing);
  packer.put(columns.blocked);
  packer.put(columns.high);
  packer.put(columns.ground);
  packer.put(layers.paint.cells);
  return packer.pack();
}

/// Throws std::runtime_error if the data are not packed layers.
std::unique_ptr<TileLayers> unpack(const PackedValues& packed) {
  ValueUnpacker unpacker(packed);
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
  return layers;
}

}  // namespace

void SleepingLayers::sleep(SpillFile& file) {
  if (!awake_) return;
  spilled_ = file.put(pack(*awake_));
  awake_.reset();
}

bool SleepingLayers::wake() {
  if (awake_) return true;
  try {
    awake_ = unpack(std::exchange(spilled_, {}).read());
  } catch (const std::runtime_error&) {
    awake_ = std::make_unique<TileLayers>();
    return false;
  }
  return true;
}

}  // namespace curbstone::semantic_map::layers
