#pragma once

#include <random>

#include "services/viewer/store/tile_cells.hpp"

namespace curbstone::viewer {

/// A tile of random cells.
inline store::TileCells draw_cells(std::mt19937& random, std::int32_t revision) {
  store::TileCells cells{.utime = 1'700'000'000'000'000 + revision, .curbs_utime = revision, .revision = revision};
  cells.z_origin = static_cast<float>(random() % 3);
  for (std::size_t i = 0; i < store::kCellsInTile; ++i) {
    cells.cell_class[i] = static_cast<std::uint8_t>(random() % 5);
    cells.height[i] = static_cast<std::int16_t>(random());
    cells.cost[i] = static_cast<std::uint8_t>(random());
    cells.confidence[i] = static_cast<std::uint8_t>(random());
  }
  return cells;
}

/// The same tile, a few cells of it changed.
inline store::TileCells change_cells(std::mt19937& random, store::TileCells cells, std::int32_t revision) {
  cells.revision = revision;
  cells.utime += 50'000;
  for (int n = static_cast<int>(random() % 40); n > 0; --n) {
    const std::size_t i = random() % store::kCellsInTile;
    cells.cell_class[i] = static_cast<std::uint8_t>(random() % 5);
    cells.height[i] = static_cast<std::int16_t>(random());
  }
  return cells;
}

}  // namespace curbstone::viewer
