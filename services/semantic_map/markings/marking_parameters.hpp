#pragma once

#include "common/config/config.hpp"

namespace curbstone::semantic_map::markings {

/// 0..255: lower bound of a road's level, three quarters of the median of roads. Darker cells are tar.
inline constexpr double kDarkestRoad = 48;

/// Parameters of road-marking detection. Intensities: 0..255, the road's median is 64.
struct MarkingParameters {
  bool enabled = true;
  double min_contrast = 20;  ///< brighter than the ground around
  double min_sigmas = 1.5;   ///< and that many times its own uncertainty
  double side_share = 0.4;   ///< share of the contrast by which both sides must be darker, along the whole piece
  bool local = true;         ///< against the ground around; off: against `level` everywhere (ablation)
  double level = 64;         ///< the road's level, if `local` is off
  bool two_sided = true;     ///< off: one side is enough (ablation)
  bool vote = true;          ///< off: cells need no support by others (ablation)

  void visit(ConfigVisitor& v) {
    v.field("enabled", enabled, "look for road markings");
    v.field("min_contrast", min_contrast, {1, 255}, "brighter than the ground around, at least; its median is 64");
    v.field("min_sigmas", min_sigmas, {0, 100}, "the contrast in units of its own uncertainty, at least");
    v.field("side_share", side_share, {0, 1},
            "share of the contrast below which both sides must lie, along the whole marking");
    v.field("local", local, "contrast to the ground around (off: to `level` everywhere)");
    v.field("level", level, {0, 255}, "intensity of the road if `local` is off");
    v.field("two_sided", two_sided, "must be brighter than both sides (off: than one)");
    v.field("vote", vote, "require that the vote sees a line of cells (off: any piece counts)");
  }
};

}  // namespace curbstone::semantic_map::markings
