#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/tile/voted_tile.hpp"
#include "tools/bench/markings/marking_score.hpp"

namespace curbstone::bench::markings {

/// Writes a PNG: the brightness of the map, the true paint (magenta), and the detected lines by type: solid green,
/// dashed cyan, stop line orange, crossing yellow, other red, unknown blue. `painted`: in the map's frame.
void draw_markings(const std::vector<semantic_map::tile::VotedTile>& tiles, const PaintCells& painted,
                   const std::vector<semantic_map::tile::MarkingLine>& lines, const std::string& file);

}  // namespace curbstone::bench::markings
