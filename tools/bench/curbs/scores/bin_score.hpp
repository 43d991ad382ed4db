#pragma once

#include <vector>

#include "tools/bench/curbs/scenes/curb_scene.hpp"
#include "tools/evaluate/curb_score.hpp"

namespace curbstone::bench::curbs::scores {

/// The peers' measure of one scene: of the detections in each bin of 0.5 m along the road, x 0..20 m, the innermost on
/// each side; right within 0.15 m of the true foot.
struct BinScore {
  double precision = 0;
  double recall = 0;
  double rmse = 0;  ///< m, across, of the errors below 0.5 m
  double bias = 0;  ///< m, mean of them, positive towards the higher side
  int bins = 0;     ///< whose curb can be seen
  int wrong = 0;    ///< bins with a detection that is not right
  [[nodiscard]] double f1() const { return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0; }
};

/// `feet` in the scene's frame. Bins whose curb is hidden from all of `eyes` neither count nor harm, unless a detection
/// in them is wrong.
[[nodiscard]] BinScore score_bins(const std::vector<evaluate::CurbFoot>& feet, const scenes::CurbScene& scene,
                                  const std::vector<Eigen::Vector3d>& eyes);

}  // namespace curbstone::bench::curbs::scores
