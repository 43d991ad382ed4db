#pragma once

#include "common/config/config.hpp"

namespace curbstone::semantic_map::tile {

/// Parameters of ground and curbs: one set for synthetic and real data, 16 and 64 beams, low and high curbs. Thresholds
/// adapt to the noise and density of the data where possible; these are their limits.
struct CurbParameters {
  // Ground (section VI: stick threshold and the direction of the normal)
  double min_stick = 0.15;     ///< share of l1
  double min_normal_z = 0.80;  ///< of e1: a steeper surface is not ground
  // Tilt of the normal
  bool use_tilt = true;      ///< off: the step test alone (ablation)
  bool use_step = true;      ///< off: the tilt alone (ablation)
  double min_tilt = 0.03;    ///< slope relative to the ground around
  double tilt_sigmas = 1.5;  ///< and so many times the noise of the normals around
  // Two-sided height step
  double half_window = 0.36;     ///< m on each side of the step
  double half_length = 0.25;     ///< m along the curb
  double min_step = 0.038;       ///< m
  double max_step = 0.50;        ///< m; the paper: less than 0.5 m above ground
  double step_sigmas = 4.5;      ///< height in units of its own uncertainty
  double layer_sigmas = 2.0;     ///< height in units of the disagreement of the scan lines around
  double clear_share = 0.4;      ///< share of the step by which the two sides' heights must be separated
  double min_cover = 0.5;        ///< share of the 3 cm bins across a side that must hold points
  double min_weak_step = 0.018;  ///< m, where a line continues: dropped kerbs
  // Filter
  double linearity_radius = 1.0;  ///< m
  double max_linearity = 0.25;    ///< minor over major spread of the detections around
  int min_neighbours = 4;         ///< detections within linearity_radius
  double line_sigmas = 7.0;       ///< certainty of the steps along a line, times the root of its length in m

  void visit(ConfigVisitor& v) {
    v.field("min_stick", min_stick, {0, 1}, "share of l1 that a point needs to be ground");
    v.field("min_normal_z", min_normal_z, {0, 1}, "|z| of the normal, for a point to be of the ground");
    v.field("use_tilt", use_tilt, "search steps only where normals tilt (off: everywhere near the ground)");
    v.field("use_step", use_step, "require a height step (off: the tilt alone)");
    v.field("min_tilt", min_tilt, {0, 1}, "slope of the surface relative to the ground around, at least");
    v.field("tilt_sigmas", tilt_sigmas, {0, 100}, "... and in units of the noise of the normals around");
    v.field("half_window", half_window, {0.1, 1.0}, "m, on each side of the step");
    v.field("half_length", half_length, {0.05, 1.0}, "m, along the curb");
    v.field("min_step", min_step, {0.005, 0.5}, "m, height of a curb");
    v.field("max_step", max_step, {0.05, 1.0}, "m, height of a curb");
    v.field("step_sigmas", step_sigmas, {0, 100}, "height in units of its own uncertainty, at least");
    v.field("layer_sigmas", layer_sigmas, {0, 100},
            "height in units of the disagreement of the scan lines around, at least");
    v.field("clear_share", clear_share, {-10, 1},
            "share of the step by which the heights of its two sides must be separated");
    v.field("min_cover", min_cover, {0, 1}, "share of the 3 cm bins across a side that must hold points");
    v.field("min_weak_step", min_weak_step, {0.005, 0.5},
            "m, height of a step that continues a curb line (dropped kerbs)");
    v.field("linearity_radius", linearity_radius, {0.2, 2.0}, "m, around a detection");
    v.field("max_linearity", max_linearity, {0, 1}, "minor over major spread of the detections around");
    v.field("line_sigmas", line_sigmas, {0, 1000}, "certainty of the steps along a line, times the root of its length");
    v.field("min_neighbours", min_neighbours, {1, 100}, "detections within linearity_radius");
  }
};

}  // namespace curbstone::semantic_map::tile
