#pragma once

#include "services/semantic_map/map_picture.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace curbstone {

/// The true curbs, in map: lowered kerbs paler than the others; and the true path.
[[nodiscard]] std::vector<PictureLine> truth_lines(const Truth& truth, const Pose& T_truth_map);

/// A dot on each cell that truly blocks and that the map calls free.
[[nodiscard]] std::vector<PictureLine> missed_obstacles(const BlockingScore& blocking, const Pose& T_truth_map);

}  // namespace curbstone
