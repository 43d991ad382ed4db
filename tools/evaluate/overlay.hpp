#pragma once

#include "services/semantic_map/picture/map_picture.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace curbstone::evaluate {

/// The true curbs, in map: lowered kerbs paler than the others; and the true path.
[[nodiscard]] std::vector<semantic_map::picture::PictureLine> truth_lines(const truth::Truth& truth,
                                                                          const Pose& T_truth_map);

/// Where the map errs: yellow dots on true curbs that it does not have, cyan ones on curb cells that are none, orange
/// ones on cells that truly block and that it calls free.
[[nodiscard]] std::vector<semantic_map::picture::PictureLine> error_dots(const Evaluation& evaluation);

}  // namespace curbstone::evaluate
