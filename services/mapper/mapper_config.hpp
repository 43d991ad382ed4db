#pragma once

#include <string>

#include "common/config.hpp"
#include "common/vehicle.hpp"
#include "services/mapper/atlas_config.hpp"
#include "services/mapper/dense_config.hpp"
#include "services/mapper/icp_config.hpp"
#include "services/mapper/loam_config.hpp"
#include "services/mapper/loop_config.hpp"

namespace curbstone {

/// The mapper's settings; every default is good for an RS-LiDAR-16 on a vehicle.
struct MapperConfig {
  std::string method = "icp";
  int threads = 2;  ///< 2: the dense map is worked on beside registration
  std::string mode =
      "map";           ///< map: begins a new map; extend: goes on with the one in `folder`; localise: only uses it
  std::string folder;  ///< the map on disk; written while driving and at the end (map, extend); empty: not kept
  double save_every = 60.0;         ///< s between two times that what is new goes to the disk; 0: only at the end
  double start_x = 0;               ///< m in that map, where the drive begins...
  double start_y = 0;               ///< m
  double start_yaw = 0;             ///< rad
  double start_radius = 5.0;        ///< m, ...to about this; found by searching
  double odometry_wait_s = 0.25;    ///< s of lidar time that a revolution waits for odometry
  double start_wait_s = 2.0;        ///< s of lidar time that the first revolution waits for odometry
  double prior_translation = 0.03;  ///< 1 sigma of odometry, m a metre driven
  double prior_rotation = 0.02;     ///< 1 sigma of odometry, rad a rad turned
  double prior_floor_m = 0.01;      ///< m, added to it each revolution
  double prior_floor_rad = 0.003;   ///< rad, added to it each revolution
  int min_points = 400;             ///< of a revolution that is worth registering
  double min_overlap = 0.1;         ///< share of points for which the map must have a surface; below, refused
  double min_inliers = 0.6;         ///< of those, the share that must lie on it; below, refused
  double max_residual = 0.15;       ///< m; above, the revolution is refused
  double max_jump_m = 0.5;          ///< m against odometry, beyond which registration is not believed
  double max_jump_rad = 0.15;       ///< rad against odometry
  double max_speed = 40.0;          ///< m/s: odometry that claims more is not believed
  double max_turn = 6.0;            ///< rad/s, likewise
  double keyframe_m = 0.05;         ///< m moved until a revolution goes into the map for registration
  double keyframe_rad = 0.01;       ///< rad turned until it does
  VehicleConfig vehicle;
  IcpConfig icp;
  LoamConfig loam;
  AtlasConfig atlas;
  LoopConfig loop;
  DenseConfig dense;

  void visit(ConfigVisitor& v) {
    v.choice("method", method, {"icp", "loam"}, "of registration");
    v.field("threads", threads, {1, 2}, "2: the dense map is worked on beside registration");
    v.choice("mode", mode, {"map", "extend", "localise"}, "what becomes of the map in `folder`");
    v.field("folder", folder, "the map on disk; empty: not kept");
    v.field("save_every", save_every, {0.0, 86400.0}, "s between two times that it is saved; 0: only at the end");
    v.field("start_x", start_x, {-1e6, 1e6}, "m in that map, where the drive begins");
    v.field("start_y", start_y, {-1e6, 1e6}, "m");
    v.field("start_yaw", start_yaw, {-7.0, 7.0}, "rad");
    v.field("start_radius", start_radius, {0.0, 1e6}, "m, how well that is known");
    v.field("odometry_wait_s", odometry_wait_s, {0.02, 5.0}, "s of lidar time that a revolution waits for odometry");
    v.field("start_wait_s", start_wait_s, {0.02, 60.0}, "s of lidar time that the first one waits");
    v.field("prior_translation", prior_translation, {0.0, 1.0}, "1 sigma of odometry, m a metre driven");
    v.field("prior_rotation", prior_rotation, {0.0, 1.0}, "1 sigma of odometry, rad a rad turned");
    v.field("prior_floor_m", prior_floor_m, {1e-4, 1.0}, "m, 1 sigma, added each revolution");
    v.field("prior_floor_rad", prior_floor_rad, {1e-5, 1.0}, "rad, 1 sigma, added each revolution");
    v.field("min_points", min_points, {10, 100000}, "of a revolution that is worth registering");
    v.field("min_overlap", min_overlap, {0.0, 1.0}, "share of points with a surface in the map, below: refused");
    v.field("min_inliers", min_inliers, {0.0, 1.0}, "ratio of inliers below which a revolution is refused");
    v.field("max_residual", max_residual, {0.01, 2.0}, "m, RMS above which a revolution is refused");
    v.field("max_jump_m", max_jump_m, {0.01, 100.0}, "m against odometry that is not believed");
    v.field("max_jump_rad", max_jump_rad, {0.001, 3.0}, "rad against odometry that is not believed");
    v.field("max_speed", max_speed, {1.0, 1000.0}, "m/s, odometry that claims more is not believed");
    v.field("max_turn", max_turn, {0.1, 100.0}, "rad/s, odometry that claims more is not believed");
    v.field("keyframe_m", keyframe_m, {0.0, 10.0}, "m moved until the registration map takes a revolution");
    v.field("keyframe_rad", keyframe_rad, {0.0, 3.0}, "rad turned until it does");
    v.section("vehicle", vehicle, "what the parts share about the vehicle");
    v.section("icp", icp, "point-to-plane registration");
    v.section("loam", loam, "registration by edges and planes");
    v.section("atlas", atlas, "what is remembered of the drive");
    v.section("loop", loop, "closing loops");
    v.section("dense", dense, "the dense map");
  }
};

}  // namespace curbstone
