#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::curb_lines {

/// m in map: the height of the ground that was seen at a place; nothing where none was.
using SeenGround = std::function<std::optional<double>(const Eigen::Vector2d& at)>;

/// Behind `lines` those that nobody saw: the rest of a curb behind a parked vehicle, between two measured lines of
/// which each goes on where the other points to, as high and at the same side, at most 8 m apart. Not where the ground
/// was seen on both sides of the bridge without a step between them (a driveway, an open road), nor where another line
/// lies. The bridge begins and ends at vertices of measured lines, is `inferred`, and its confidence is half of the
/// less certain one's. `lines`: measured, the high side on the right; ids go on from their number. The same lines and
/// the same ground give the same bridges.
void add_inferred(const SeenGround& ground, std::vector<tile::CurbLine>& lines);

}  // namespace curbstone::semantic_map::curb_lines
