#pragma once

#include "services/semantic_map/picture/map_picture.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace curbstone::evaluate {

/// The true curbs, in map, lowered ones paler; and the true path.
[[nodiscard]] std::vector<semantic_map::picture::PictureLine> truth_lines(const truth::Truth& truth,
                                                                          const Pose& T_truth_map);

/// The errors of the map: yellow dots on true curbs that it misses, cyan ones on false curb cells, orange ones on truly
/// blocked cells that it calls free, small violet ones on road that it calls blocked.
[[nodiscard]] std::vector<semantic_map::picture::PictureLine> error_dots(const Evaluation& evaluation);

}  // namespace curbstone::evaluate
