#pragma once

#include <vector>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::worker {

/// Section `tensor_voting` of the vehicle's file.
struct TensorVotingConfig {
  VehicleConfig vehicle;
  /// m: the scales. {0.3, 0.1} with voxels {0.1, 0.05} votes at two scales; semantic_map reads the one nearest to 0.3.
  std::vector<double> sigma = {0.3};
  std::vector<double> voxel = {0.1};  ///< m: thinning at each scale; a multiple of 2 mm that divides 3 m
  double radius = 3.0;                ///< cut-off, in sigmas
  double ball = 1.0;                  ///< the ball vote's coefficient
  double bandwidth = 24.0;            ///< MB/s of VOTED_POINTS at most
  double min_interval = 0.03;         ///< s between two revisions of a tile
  double keep_radius = 150.0;         ///< m: tiles farther from the vehicle are released
  int max_points = 16'000'000;        ///< of the map, in memory
  double worker_timeout = 2.5;        ///< s: a worker not heard for so long has left

  void visit(ConfigVisitor& v) {
    v.section("vehicle", vehicle, "the vehicle");
    v.field("sigma", sigma, {0.002, 1.0}, "m, decay of the vote: one for each scale", true);
    v.field("voxel", voxel, {0.0, 1.0}, "m, the first point of a voxel votes: one for each scale", true);
    v.field("radius", radius, {1.0, 10.0}, "sigmas, cut-off of the vote (at most 3 m)");
    v.field("ball", ball, {0.5, 1.0}, "coefficient of the ball vote: 1 straight continuation, 0.5 cos^2");
    v.field("bandwidth", bandwidth, {0.1, 100.0}, "MB/s of VOTED_POINTS at most");
    v.field("min_interval", min_interval, {0.0, 10.0}, "s between two revisions of a tile");
    v.field("keep_radius", keep_radius, {20.0, 1e6}, "m, tiles farther from the vehicle are released");
    v.field("max_points", max_points, {1000, 1e9}, "points of the map in memory");
    v.field("worker_timeout", worker_timeout, {0.5, 60.0}, "s, a worker not heard for so long is gone");
  }

  /// The parameters of each scale. Throws std::invalid_argument that names the invalid value.
  [[nodiscard]] std::vector<voting::VotingParameters> scales() const;
};

}  // namespace curbstone::tensor_voting::worker
