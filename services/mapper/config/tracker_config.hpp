#pragma once

#include "common/config/config.hpp"

namespace curbstone::mapper::config {

/// Settings of the pose prediction, of the acceptance of registrations, and of the choice of scans for the map.
struct TrackerConfig {
  double prior_translation = 0.03;
  double prior_rotation = 0.02;
  double prior_floor_m = 0.01;
  double prior_floor_rad = 0.003;
  int min_points = 400;
  double min_overlap = 0.1;
  double min_inliers = 0.6;
  double max_residual = 0.15;
  double max_jump_m = 0.5;
  double max_jump_rad = 0.15;
  double max_speed = 40.0;
  double max_turn = 6.0;
  bool turn_by_odometry = true;
  double keyframe_m = 0.05;
  double keyframe_rad = 0.01;

  void visit(ConfigVisitor& v) {
    v.field("prior_translation", prior_translation, {0.0, 1.0}, "m per metre driven, 1 sigma of odometry");
    v.field("prior_rotation", prior_rotation, {0.0, 1.0}, "rad per rad turned, 1 sigma of odometry");
    v.field("prior_floor_m", prior_floor_m, {1e-4, 1.0}, "m, 1 sigma, added for each scan");
    v.field("prior_floor_rad", prior_floor_rad, {1e-5, 1.0}, "rad, 1 sigma, added for each scan");
    v.field("min_points", min_points, {10, 100000}, "points that a scan must have to be registered");
    v.field("min_overlap", min_overlap, {0.0, 1.0},
            "share of points with a surface in the map; a scan with less is refused");
    v.field("min_inliers", min_inliers, {0.0, 1.0},
            "share of those points that lie on that surface; a scan with less is refused");
    v.field("max_residual", max_residual, {0.01, 2.0}, "m, RMS distance above which a scan is refused");
    v.field("max_jump_m", max_jump_m, {0.01, 100.0},
            "m, difference from odometry beyond which a registration is refused");
    v.field("max_jump_rad", max_jump_rad, {0.001, 3.0}, "rad, likewise");
    v.field("max_speed", max_speed, {1.0, 1000.0}, "m/s, odometry that is faster is not used");
    v.field("max_turn", max_turn, {0.1, 100.0}, "rad/s, odometry that turns faster is not used");
    v.field("turn_by_odometry", turn_by_odometry,
            "a revolution that turns by 1 deg within a second otherwise than wheels and gyro, which agree, is refused: "
            "it follows what drives along, as lorries on both sides");
    v.field("keyframe_m", keyframe_m, {0.0, 10.0}, "m moved until the next scan is inserted into the registration map");
    v.field("keyframe_rad", keyframe_rad, {0.0, 3.0}, "rad turned, likewise");
  }
};

}  // namespace curbstone::mapper::config
