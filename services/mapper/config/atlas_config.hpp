#pragma once

#include "common/config/config.hpp"

namespace curbstone::mapper::config {

/// The drive's pose graph, from which the map is rebuilt when necessary.
///
/// The covariance of an edge of the drive is the drift of the map along it: a random walk, so sigma grows with the root
/// of the length. The covariance that registration gives its two poses is not used: every node is registered to the map
/// of its neighbours, so these errors do not add up along the drive, as a chain of independent edges would assume. The
/// steps cover the drift of the worse method: t_rel and r_rel of `curbstone bench mapping` on the recorded street, over
/// 10..60 m, are a random walk of 7.3 to 8.0 mm and 0.33 mrad per root metre and axis with loam, 4.8 to 5.7 mm and 0.15
/// to 0.16 mrad with icp (the mean of 1 / sqrt(length) is 0.19, that of a norm over three axes 1.6 sigma).
struct AtlasConfig {
  double spacing = 1.0;
  double node_voxel = 0.2;
  double node_range = 60.0;
  double connected = 120.0;
  double step_m = 0.01;
  double step_rad = 0.0005;
  int max_nodes = 20'000;

  void visit(ConfigVisitor& v) {
    v.field("spacing", spacing, {0.2, 20.0}, "m of new ground between keyframes");
    v.field("node_voxel", node_voxel, {0.05, 2.0}, "m, the scan of a keyframe is thinned to one point per voxel");
    v.field("node_range", node_range, {5.0, 65.0}, "m, farther points of a keyframe's scan are not kept");
    v.field("connected", connected, {10.0, 10'000.0},
            "m along the graph within which drift does not disturb registration");
    v.field("step_m", step_m, {1e-4, 1.0}, "m, 1 sigma of an edge of one metre; grows with the root of the length");
    v.field("step_rad", step_rad, {1e-6, 0.1}, "rad, likewise");
    v.field("max_nodes", max_nodes, {100, 1'000'000},
            "keyframes that keep their scan while no disk takes it; beyond that the farthest lose theirs");
  }
};

}  // namespace curbstone::mapper::config
