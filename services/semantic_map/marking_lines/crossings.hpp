#pragma once

#include <vector>

#include "services/semantic_map/marking_lines/marking_pieces.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::marking_lines {

/// Finds pedestrian crossings: three or more broad bars side by side at even distances, and neighbouring bars of which
/// only a part is seen. Removes their pieces, and pieces that seem to lie across their bars: nothing else is painted
/// there.
[[nodiscard]] std::vector<tile::MarkingLine> extract_crossings(std::vector<MarkingPiece>& pieces);

}  // namespace curbstone::semantic_map::marking_lines
