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
    v.field("edge_bend", edge_bend, {0.005, 1.0},
            "m from the mean of its neighbours, from which on a point is an edge");
    v.field("plane_bend", plane_bend, {0.005, 1.0}, "m from that mean, below which a point is plane");
    v.field("sectors", sectors, {1, 60}, "sectors of a ring, from each of which features are chosen");
    v.field("edges_per_sector", edges_per_sector, {1, 1000}, "at most");
    v.field("planes_per_sector", planes_per_sector, {1, 10000}, "at most, for registration; the map takes all of them");
    v.field("plane_voxel", plane_voxel, {0.02, 2.0}, "m, plane features are thinned to one per voxel");
    v.field("max_range", max_range, {2.0, 200.0}, "m, farther points are not used");
    v.field("window", window, {10.0, 500.0}, "m, half size of the maps around the vehicle");
    v.field("fine_voxel", fine_voxel, {0.05, 2.0}, "m, of the planes");
    v.field("coarse_voxel", coarse_voxel, {0.1, 10.0}, "m, of the planes where points are too sparse for fine ones");
    v.field("edge_voxel", edge_voxel, {0.1, 10.0}, "m, of the edges");
    v.field("min_grazing", min_grazing, {0.0, 0.5}, "as of icp");
    v.field("sensor_sigma", sensor_sigma, {0.001, 0.5}, "m, noise of a range");
    v.field("kernel", kernel, {0.5, 20.0}, "sigmas, bound of the Huber kernel");
    v.field("search", search, {0.05, 5.0},
            "m, search distance to an edge or plane in the first round, if the prior is poor");
    v.field("max_rounds", max_rounds, {1, 100}, "of matching");
    v.field("degenerate_below", degenerate_below, {0.0, 0.5}, "as of icp; few features point along a street");
  }
};

}  // namespace curbstone::mapper::config
