#include "services/semantic_map/tile_pipeline.hpp"

/// @file
/// TilePipeline: tiles that fall asleep, and wake.

namespace curbstone::semantic_map {

void TilePipeline::wake(TileKey key, Tile& tile) {
  if (tile.layers.asleep()) {
    if (!tile.layers.wake()) lost_.push_back(key);
    awakened_.push_back(key);
  }
  uses_.used(key, num_voted_);
}

void TilePipeline::sleep(TileKey key) {
  uses_.erase(key);
  meters_.erase(key);
  if (Tile* const tile = find(key)) tile->layers.sleep(*far_);
}

}  // namespace curbstone::semantic_map
