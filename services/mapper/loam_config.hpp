#pragma once

#include "common/config.hpp"

namespace curbstone {

/// Registration by edge and plane features.
struct LoamConfig {
  double edge_bend = 0.10;          ///< m that a point stands off its neighbours' mean, from which it is an edge
  double plane_bend = 0.10;         ///< m, below which it is plane
  int sectors = 6;                  ///< of a ring, for an even choice
  int edges_per_sector = 8;         ///< at most
  int planes_per_sector = 40;       ///< at most, for registration; the map takes all
  double plane_voxel = 0.20;        ///< m: plane features are thinned to one a voxel
  double max_range = 60.0;          ///< m
  double window = 80.0;             ///< m: the maps are kept within this of the vehicle
  double fine_voxel = 0.30;         ///< m, of the planes
  double coarse_voxel = 1.0;        ///< m, of the planes where points are too sparse for the fine ones
  double edge_voxel = 0.60;         ///< m, of the edges
  double min_grazing = 0.05;        ///< as of icp
  double sensor_sigma = 0.02;       ///< m, noise of a range
  double kernel = 1.5;              ///< sigmas: Huber's bound
  double search = 0.5;              ///< m, to an edge or plane at the first round, without a good prior
  int max_rounds = 12;              ///< of matching
  double degenerate_below = 0.001;  ///< as of icp; few features point along a street

  void visit(ConfigVisitor& v) {
    v.field("edge_bend", edge_bend, {0.005, 1.0}, "m off its neighbours' mean, from which a point is an edge");
    v.field("plane_bend", plane_bend, {0.005, 1.0}, "m, below which it is plane");
    v.field("sectors", sectors, {1, 60}, "of a ring, for an even choice");
    v.field("edges_per_sector", edges_per_sector, {1, 1000}, "at most");
    v.field("planes_per_sector", planes_per_sector, {1, 10000}, "at most, for registration");
    v.field("plane_voxel", plane_voxel, {0.02, 2.0}, "m, plane features are thinned to one a voxel");
    v.field("max_range", max_range, {2.0, 200.0}, "m, points beyond are not used");
    v.field("window", window, {10.0, 500.0}, "m, the maps are kept within this of the vehicle");
    v.field("fine_voxel", fine_voxel, {0.05, 2.0}, "m, of the planes");
    v.field("coarse_voxel", coarse_voxel, {0.1, 10.0}, "m, of the planes where points are sparse");
    v.field("edge_voxel", edge_voxel, {0.1, 10.0}, "m, of the edges");
    v.field("min_grazing", min_grazing, {0.0, 0.5}, "sine of the angle at which rays must meet a plane");
    v.field("sensor_sigma", sensor_sigma, {0.001, 0.5}, "m, noise of a range");
    v.field("kernel", kernel, {0.5, 20.0}, "sigmas, Huber's bound");
    v.field("search", search, {0.05, 5.0}, "m, to an edge or plane at the first round");
    v.field("max_rounds", max_rounds, {1, 100}, "of matching");
    v.field("degenerate_below", degenerate_below, {0.0, 0.5}, "share of the constraint that is none");
  }
};

}  // namespace curbstone
