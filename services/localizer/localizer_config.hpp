#pragma once

#include <string>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "services/localizer/tracking/tracking_config.hpp"

namespace curbstone::localizer {

/// The `localizer:` section of a vehicle's file.
struct LocalizerConfig {
  std::string map = "/var/lib/curbstone/map.db";
  double start_x = 0;
  double start_y = 0;
  double start_yaw = 0;
  double start_sigma = 0.15;
  double start_yaw_sigma = 0.03;
  double odometry_wait_s = 0.25;
  tracking::TrackingConfig tracking;
  VehicleConfig vehicle;

  void visit(ConfigVisitor& v) {
    v.field("map", map, "the saved map, as curbstone-semantic-map wrote it; it is only read");
    v.field("start_x", start_x, {-1e6, 1e6}, "m in that map, where base_link is at the start");
    v.field("start_y", start_y, {-1e6, 1e6}, "m");
    v.field("start_yaw", start_yaw, {-7.0, 7.0}, "rad");
    v.field("start_sigma", start_sigma, {0.001, 1.0}, "m, 1 sigma of that place");
    v.field("start_yaw_sigma", start_yaw_sigma, {0.0001, 0.2}, "rad, 1 sigma of that direction");
    v.field("odometry_wait_s", odometry_wait_s, {0.02, 5.0}, "s of lidar time that a revolution waits for odometry");
    tracking.visit(v);
    v.section("vehicle", vehicle, "where the LiDAR is");
  }
};

}  // namespace curbstone::localizer
