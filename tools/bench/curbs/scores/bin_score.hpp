#pragma once

#include <vector>

#include "tools/bench/curbs/scenes/curb_scene.hpp"
#include "tools/evaluate/curb_score.hpp"

namespace curbstone::bench::curbs::scores {

/// Score of one scene, with the measure of other methods: in each bin of 0.5 m along the road, x 0..20 m, the innermost
/// detection on each side counts; it is right within 0.15 m of the true foot.
struct BinScore {
  double precision = 0;
  double recall = 0;
  double rmse = 0;  ///< m, lateral, of the errors below 0.5 m
  double bias = 0;  ///< m, their mean, positive towards the higher side
  int bins = 0;     ///< with a visible curb
  int wrong = 0;    ///< bins with a wrong detection
  [[nodiscard]] double f1() const { return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0; }
};

/// `feet` in the scene's frame. A bin whose curb is hidden from all of `eyes` does not count, unless it has a wrong
/// detection.
[[nodiscard]] BinScore score_bins(const std::vector<evaluate::CurbFoot>& feet, const scenes::CurbScene& scene,
                                  const std::vector<Eigen::Vector3d>& eyes);

}  // namespace curbstone::bench::curbs::scores
