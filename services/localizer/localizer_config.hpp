#pragma once

#include <string>
#include <vector>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "services/localizer/monte_carlo/monte_carlo_config.hpp"
#include "services/localizer/tracking/tracking_config.hpp"

namespace curbstone::localizer {

enum class Method {
  kGaussNewton,  ///< tracks, detects when it is lost, searches the whole map
  kMonteCarlo,   ///< AMCL for comparison; needs a start pose
};

/// The `localizer:` section of a vehicle's file.
struct LocalizerConfig {
  std::string map = "/var/lib/curbstone/map.db";
  Method method = Method::kGaussNewton;
  std::vector<double> start;
  double start_sigma = 0.15;
  double start_yaw_sigma = 0.03;
  double odometry_wait_s = 0.25;
  tracking::TrackingConfig tracking;
  monte_carlo::MonteCarloConfig monte_carlo;
  VehicleConfig vehicle;

  void visit(ConfigVisitor& v) {
    v.field("map", map, "the saved map, as curbstone-semantic-map wrote it; it is only read");
    v.choice("method", method, {{"gauss_newton", Method::kGaussNewton}, {"mcl", Method::kMonteCarlo}},
             "how the pose is tracked; mcl, a plain particle filter, is for comparison");
    v.field("start", start, {-1e6, 1e6}, "[X, Y, YAW] of base_link in that map at the start, m, rad; empty: unknown",
            true);
    v.field("start_sigma", start_sigma, {0.001, 1.0}, "m, 1 sigma of that place");
    v.field("start_yaw_sigma", start_yaw_sigma, {0.0001, 0.2}, "rad, 1 sigma of that direction");
    v.field("odometry_wait_s", odometry_wait_s, {0.02, 5.0}, "s of lidar time that a revolution waits for odometry");
    tracking.visit(v);
    v.section("mcl", monte_carlo, "of method mcl");
    v.section("vehicle", vehicle, "where the LiDAR is");
  }
};

}  // namespace curbstone::localizer
