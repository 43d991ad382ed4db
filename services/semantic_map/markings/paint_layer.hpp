#pragma once

#include <cstdint>
#include <vector>

#include "services/semantic_map/ground/ground_model.hpp"
#include "services/semantic_map/tile/map_types.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::markings {

/// Brightness of the ground in a 0.12 m cell: sums over its points, so that the points' order does not matter.
struct PaintCell {
  std::uint32_t count = 0;
  std::uint32_t sum = 0;             ///< of intensities
  std::uint32_t squares = 0;         ///< of intensities
  std::uint32_t x = 0, y = 0;        ///< sums, 2 mm steps from the cell's corner
  std::uint32_t by_x = 0, by_y = 0;  ///< the same, each times its intensity
  float z = 0;                       ///< m in map, of the ground
  bool operator==(const PaintCell&) const = default;
};

/// The intensities on the ground of a tile, cell by cell; empty where none is known.
struct PaintLayer {
  std::vector<PaintCell> cells;
  bool operator==(const PaintLayer&) const = default;
};

/// Sums up the points within 5 cm of the ground whose intensity is known (not 0).
[[nodiscard]] PaintLayer accumulate_paint(const tile::VotedTile& tile, const ground::GroundSurface& ground);

}  // namespace curbstone::semantic_map::markings
