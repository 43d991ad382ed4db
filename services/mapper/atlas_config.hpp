#pragma once

#include "common/config.hpp"

namespace curbstone {

/// What is remembered of the drive, for whatever must be built anew.
struct AtlasConfig {
  double spacing = 1.0;      ///< m between nodes
  double node_voxel = 0.2;   ///< m: a node's scan is thinned to one point a voxel
  double node_range = 60.0;  ///< m, at most 65
  double connected = 120.0;  ///< m along the graph, within which drift is too small to matter for registration
  double step_m = 0.01;      ///< m, 1 sigma of an edge of one metre; grows with the root of the length
  double step_rad = 0.0005;  ///< rad, likewise
  int max_nodes = 20'000;    ///< that keep their scan; beyond, the farthest lose theirs

  void visit(ConfigVisitor& v) {
    v.field("spacing", spacing, {0.2, 20.0}, "m between nodes");
    v.field("node_voxel", node_voxel, {0.05, 2.0}, "m, a node's scan is thinned to one point a voxel");
    v.field("node_range", node_range, {5.0, 65.0}, "m, of a node's scan");
    v.field("connected", connected, {10.0, 10'000.0}, "m along the graph within which drift does not matter");
    v.field("step_m", step_m, {1e-4, 1.0}, "m, 1 sigma of an edge of one metre");
    v.field("step_rad", step_rad, {1e-6, 0.1}, "rad, 1 sigma of an edge of one metre");
    v.field("max_nodes", max_nodes, {100, 1'000'000}, "that keep their scan");
  }
};

}  // namespace curbstone
