#include "services/semantic_map/pipeline/tile_pipeline.hpp"

/// @file
/// TilePipeline: puts tiles to sleep and wakes them.

namespace curbstone::semantic_map::pipeline {

void TilePipeline::wake(TileKey key, Tile& tile) {
  const bool slept = tile.layers.asleep();
  if (slept) {
    if (!tile.layers.wake()) lost_.push_back(key);
    awakened_.push_back(key);
  }
  if (does_old_step_ && (slept || visits_.contains(key))) return visits_.used(key, now_);
  visits_.erase(key);
  uses_.used(key, now_);
}

/// Wakes the tiles that compute() reads.
void TilePipeline::wake_for(Step step, TileKey key, Tile& tile) {
  switch (step) {
    case kCurbs:  // reads the evidence, which never sleeps
      return;
    case kSamples:
    case kColumns:
    case kPaint:
      wake(key, tile);
      return;
    default:
      for_around(key, [this](TileKey k, Tile& t) { wake(k, t); });
  }
}

void TilePipeline::sleep(TileKey key) {
  uses_.erase(key);
  visits_.erase(key);
  accumulators_.erase(key);
  if (Tile* const tile = find(key)) tile->layers.sleep(*spill_file_);
}

/// At most one tile of each kind in a call, so that no message waits for many tiles to be packed.
void TilePipeline::let_sleep() {
  if (const auto unused = uses_.take_unused(kAwake, now_)) sleep(*unused);
  if (const auto unused = visits_.take_unused(kAwakeForOldStep, now_)) sleep(*unused);
}

}  // namespace curbstone::semantic_map::pipeline
