#pragma once

#include <vector>

#include "services/semantic_map/map_types.hpp"
#include "tools/evaluate/curb_score.hpp"

namespace curbstone {

/// Places along the feet of curb lines, at most `spacing` m apart: what is scored, as it is what a planner gets.
[[nodiscard]] std::vector<CurbFoot> feet_along(const std::vector<CurbLine>& lines, double spacing = 0.1);

}  // namespace curbstone
