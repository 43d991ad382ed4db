#pragma once

#include <memory>

#include "common/packing/spill_file.hpp"
#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/ground/ground_samples.hpp"
#include "services/semantic_map/markings/paint_layer.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::layers {

/// What of a tile nobody but the steps of it and of its neighbours reads.
struct TileLayers {
  tile::VotedTile voted;
  ground::GroundSamples samples;
  cells::CellColumns columns;
  markings::PaintLayer paint;
};

/// The layers of a tile, which are nearly all of its memory and may sleep: packed, and in a file where there is one,
/// until somebody looks at them again. What wakes has every bit that it had. Copies are of their own.
class SleepingLayers {
 public:
  SleepingLayers() = default;
  SleepingLayers(const SleepingLayers& other)
      : awake_(other.awake_ ? std::make_unique<TileLayers>(*other.awake_) : nullptr), away_(other.away_) {}
  SleepingLayers(SleepingLayers&&) noexcept = default;
  SleepingLayers& operator=(const SleepingLayers& other) { return *this = SleepingLayers(other); }
  SleepingLayers& operator=(SleepingLayers&&) noexcept = default;
  ~SleepingLayers() = default;

  [[nodiscard]] bool asleep() const { return !awake_; }
  void sleep(SpillFile& file);
  /// False if the file cannot be read: then they are empty, as of a tile of which nothing has come.
  [[nodiscard]] bool wake();
  /// Not of layers that sleep.
  [[nodiscard]] TileLayers* operator->() { return awake_.get(); }
  [[nodiscard]] const TileLayers* operator->() const { return awake_.get(); }

 private:
  std::unique_ptr<TileLayers> awake_ = std::make_unique<TileLayers>();
  SpillFile::Values away_;
};

}  // namespace curbstone::semantic_map::layers
