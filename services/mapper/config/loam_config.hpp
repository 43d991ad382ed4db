#pragma once

#include "common/config/config.hpp"

namespace curbstone::mapper::config {

/// Settings of registration by edge and plane features.
struct LoamConfig {
  double edge_bend = 0.10;
  double plane_bend = 0.10;
  int sectors = 6;
  int edges_per_sector = 8;
  int planes_per_sector = 40;
  double plane_voxel = 0.20;
  double max_range = 60.0;
  double window = 80.0;
  double fine_voxel = 0.30;
  double coarse_voxel = 1.0;
  double edge_voxel = 0.60;
  double min_grazing = 0.05;
  double sensor_sigma = 0.02;
  double kernel = 1.5;
  double search = 0.5;
  int max_rounds = 12;
  double degenerate_below = 0.001;

  void visit(ConfigVisitor& v) {
    v.field("edge_bend", edge_bend, {0.005, 1.0}, "m off its neighbours' mean, from which a point is an edge");
    v.field("plane_bend", plane_bend, {0.005, 1.0}, "m off it, below which a point is plane");
    v.field("sectors", sectors, {1, 60}, "of a ring, for an even choice");
    v.field("edges_per_sector", edges_per_sector, {1, 1000}, "at most");
    v.field("planes_per_sector", planes_per_sector, {1, 10000}, "at most, for registration; the map takes all");
    v.field("plane_voxel", plane_voxel, {0.02, 2.0}, "m, plane features are thinned to one a voxel");
    v.field("max_range", max_range, {2.0, 200.0}, "m, points beyond are not used");
    v.field("window", window, {10.0, 500.0}, "m, the maps are kept within this of the vehicle");
    v.field("fine_voxel", fine_voxel, {0.05, 2.0}, "m, of the planes");
    v.field("coarse_voxel", coarse_voxel, {0.1, 10.0},
            "m, of the planes where points are too sparse for the fine ones");
    v.field("edge_voxel", edge_voxel, {0.1, 10.0}, "m, of the edges");
    v.field("min_grazing", min_grazing, {0.0, 0.5}, "as of icp");
    v.field("sensor_sigma", sensor_sigma, {0.001, 0.5}, "m, noise of a range");
    v.field("kernel", kernel, {0.5, 20.0}, "sigmas, Huber's bound");
    v.field("search", search, {0.05, 5.0}, "m, to an edge or plane at the first round, without a good prior");
    v.field("max_rounds", max_rounds, {1, 100}, "of matching");
    v.field("degenerate_below", degenerate_below, {0.0, 0.5}, "as of icp; few features point along a street");
  }
};

}  // namespace curbstone::mapper::config
