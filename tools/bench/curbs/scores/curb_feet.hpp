#pragma once

#include <vector>

#include "services/semantic_map/tile/map_types.hpp"
#include "tools/evaluate/curb_score.hpp"

namespace curbstone::bench::curbs::scores {

/// Points along the feet of curb lines, at most `spacing` m apart. These are scored because a planner uses them.
[[nodiscard]] std::vector<evaluate::CurbFoot> feet_along(const std::vector<semantic_map::tile::CurbLine>& lines,
                                                         double spacing = 0.1);

}  // namespace curbstone::bench::curbs::scores
