#pragma once

#include <memory>

#include "common/packing/spill_file.hpp"
#include "services/semantic_map/cells/cell_columns.hpp"
#include "services/semantic_map/ground/ground_samples.hpp"
#include "services/semantic_map/markings/paint_layer.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::layers {

/// The parts of a tile that only the steps of this tile and of its neighbours read.
struct TileLayers {
  tile::VotedTile voted;
  ground::GroundSamples samples;
  cells::CellColumns columns;
  markings::PaintLayer paint;
};

/// The layers of a tile, nearly all of its memory. They may sleep: packed, and in a file if there is one, until they
/// are read again. They wake bit-identical. Copies are independent.
class SleepingLayers {
 public:
  SleepingLayers() = default;
  SleepingLayers(const SleepingLayers& other)
      : awake_(other.awake_ ? std::make_unique<TileLayers>(*other.awake_) : nullptr), spilled_(other.spilled_) {}
  SleepingLayers(SleepingLayers&&) noexcept = default;
  SleepingLayers& operator=(const SleepingLayers& other) { return *this = SleepingLayers(other); }
  SleepingLayers& operator=(SleepingLayers&&) noexcept = default;
  ~SleepingLayers() = default;

  [[nodiscard]] bool asleep() const { return !awake_; }
  void sleep(SpillFile& file);
  /// False if the file cannot be read: then the layers are empty, like those of a tile without points.
  [[nodiscard]] bool wake();
  /// Must not be called while the layers sleep.
  [[nodiscard]] TileLayers* operator->() { return awake_.get(); }
  [[nodiscard]] const TileLayers* operator->() const { return awake_.get(); }

 private:
  std::unique_ptr<TileLayers> awake_ = std::make_unique<TileLayers>();
  SpillFile::Values spilled_;
};

}  // namespace curbstone::semantic_map::layers
