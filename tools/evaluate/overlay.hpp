#pragma once

#include "services/semantic_map/map_picture.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace curbstone {

/// The true curbs, in map: lowered kerbs paler than the others; and the true path.
[[nodiscard]] std::vector<PictureLine> truth_lines(const Truth& truth, const Pose& T_truth_map);

/// Where the map errs: yellow dots on true curbs that it does not have, cyan ones on curb cells that are none, orange
/// ones on cells that truly block and that it calls free.
[[nodiscard]] std::vector<PictureLine> error_dots(const Evaluation& evaluation);

}  // namespace curbstone
