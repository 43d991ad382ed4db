#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::marking_lines {

/// The parts of the lines within the box; where a line continues beyond the box, its part ends on the edge. A part has
/// the type, the dimensions and the id of its line. m in map.
[[nodiscard]] std::vector<tile::MarkingLine> clip_lines(const std::vector<tile::MarkingLine>& lines,
                                                        const Eigen::Vector2d& min, const Eigen::Vector2d& max);

}  // namespace curbstone::semantic_map::marking_lines
