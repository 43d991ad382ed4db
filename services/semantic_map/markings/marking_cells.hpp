#pragma once

#include <cstdint>
#include <vector>

#include "services/semantic_map/curbs/curb_filter.hpp"
#include "services/semantic_map/markings/marking_parameters.hpp"
#include "services/semantic_map/markings/paint_layer.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::markings {

/// A cell that is brighter than the ground around it, or lies beside one.
struct MarkingCell {
  std::uint8_t column = 0, row = 0;
  bool is_strong = false;  ///< likely paint by itself
  bool is_bright = false;  ///< part of the paint, for its edges; the others are the ground beside it
  std::uint8_t count = 0;  ///< points that the contrast is computed from; 255: or more
  float x = 0, y = 0;      ///< m from the tile's corner, centroid of the bright part
  float z = 0;             ///< m in map
  float contrast = 0;      ///< over the ground around, -255..255
  float level = 0;         ///< of that ground, 0..255
  bool operator==(const MarkingCell&) const = default;
};

/// Inputs for the cells of a tile.
struct MarkingSurroundings {
  tile::Around<PaintLayer> paint;
  tile::Around<std::vector<curbs::CurbPoint>> curbs;
  const tile::MapTile* classes = nullptr;  ///< of the centre tile
};

/// Evidence of paint, cell by cell, in order, with all cells within 0.6 m of what is bright: contrast to the ground
/// within 1.2 m, of which paint and tar may be a part; strong if it is brighter than both sides at 0.3 to 0.5 m across,
/// stands out of its own uncertainty, and is no less than 0.25 m from a curb nor beyond one, on its higher side. Bright
/// only on ground where a vehicle may drive, and that is not half as bright again as the road's median: grass.
[[nodiscard]] std::vector<MarkingCell> find_marking_cells(const MarkingSurroundings& around,
                                                          const MarkingParameters& parameters);

}  // namespace curbstone::semantic_map::markings
