#pragma once

#include <algorithm>

#include "common/config/config.hpp"

namespace curbstone::mapper::config {

/// Settings of the dense map.
struct DenseConfig {
  double voxel = 0.05;
  double max_range = 20.0;
  double min_height = -3.0;
  double max_height = 4.0;
  int settle_hits = 3;
  double settle_s = 0.3;
  double ground_clearance = 0.30;
  double persistence_s = 1.0;
  double start_hold_s = 30.0;
  double standing_s = 1.5;
  double free_range = 12.0;
  bool ring_scale = true;
  double awake = 40.0;
  int asleep_here = 200;
  int max_points = 30'000'000;

  /// s, until every hit has settled in the map or has been dropped: held voxels are tested every fourth scan.
  [[nodiscard]] double settled_after() const { return std::max(settle_s, persistence_s) + 0.2; }

  void visit(ConfigVisitor& v) {
    v.field("voxel", voxel, {0.02, 0.5}, "m, one point per voxel; a whole number of 2 mm steps that divides 3 m");
    v.field("max_range", max_range, {2.0, 100.0}, "m, horizontally from base_link; farther points are too noisy");
    v.field("min_height", min_height, {-20.0, 0.0}, "m above base_link");
    v.field("max_height", max_height, {0.0, 30.0}, "m above base_link");
    v.field("settle_hits", settle_hits, {1, 100}, "hits whose mean becomes the voxel's point");
    v.field("settle_s", settle_s, {0.0, 10.0}, "s after which fewer hits suffice");
    v.field("ground_clearance", ground_clearance, {0.05, 5.0},
            "m above the lowest point of its column, from which on a point may be moving");
    v.field("persistence_s", persistence_s, {0.0, 60.0},
            "s for which a place must be occupied before a point that may be moving is added");
    v.field("start_hold_s", start_hold_s, {0.0, 600.0},
            "s for which the first standstill has a map of its own, unless the vehicle moves before");
    v.field("standing_s", standing_s, {0.0, 600.0}, "s of standstill after which nothing new is added");
    v.field("free_range", free_range, {0.0, 50.0},
            "m within which points that beams pass through are removed, and behind the vehicle new ones up to "
            "max_range; 0: never");
    v.field("ring_scale", ring_scale, "intensities of all rings on one scale, learned on the road: its median is 64");
    v.field("awake", awake, {0.0, 1000.0},
            "m beyond max_range; tiles farther from the vehicle sleep: only their records are kept");
    v.field("asleep_here", asleep_here, {0, 1'000'000},
            "sleeping tiles that stay in memory; the records of the others are packed into the file of far tiles");
    v.field("max_points", max_points, {100'000, 500'000'000},
            "points in memory while no disk takes far tiles; beyond that the farthest tiles are dropped");
  }
};

}  // namespace curbstone::mapper::config
