#pragma once

#include "common/config/config.hpp"

namespace curbstone::localizer::tracking {

/// Which ground heights are compared with the map's. Level ground is always compared: it determines roll and pitch.
enum class Heights {
  kAll,
  kCurbs,  ///< only those beside a curb of the map: measures what curbs alone contribute
  kNone,
};

/// What is measured, and how much it is trusted. visit() states meaning and unit of each.
struct TrackingConfig {
  bool use_walls = true;
  Heights heights = Heights::kAll;
  bool use_paint = true;
  double height_sigma = 0.03;
  double wall_sigma = 0.06;
  double paint_sigma = 0.06;
  double independent = 0.05;
  double map_independent = 0.008;
  double map_drift_m = 0.11;
  double map_drift_rad = 0.011;
  double odometry_m = 0.02;
  double odometry_rad = 0.02;
  double odometry_floor_m = 0.0005;
  double odometry_floor_rad = 0.0002;
  double min_match = 0.5;
  double find_match = 0.6;
  double max_sigma = 0.17;

  void visit(ConfigVisitor& v) {
    v.field("use_walls", use_walls, "use upright objects");
    v.choice("heights", heights, {{"all", Heights::kAll}, {"curbs", Heights::kCurbs}, {"none", Heights::kNone}},
             "heights of the ground that are used: all, those beside curbs, or none (level ground)");
    v.field("use_paint", use_paint, "use road markings");
    v.field("height_sigma", height_sigma, {0.001, 1.0}, "m, 1 sigma of a ground point relative to the map");
    v.field("wall_sigma", wall_sigma, {0.001, 1.0}, "m, 1 sigma of a point on an upright object relative to the map");
    v.field("paint_sigma", paint_sigma, {0.001, 1.0}, "m, 1 sigma of a point of paint relative to the map's paint");
    v.field("independent", independent, {0.0001, 1.0}, "share of the points of a revolution that are independent");
    v.field("map_independent", map_independent, {0.0001, 1000.0},
            "share of the points of a revolution that were independent when the map was made");
    v.field("map_drift_m", map_drift_m, {0.0001, 1.0},
            "m, 1 sigma of the map over what is seen of it where nothing did");
    v.field("map_drift_rad", map_drift_rad, {0.0001, 1.0}, "rad, the same of its directions");
    v.field("odometry_m", odometry_m, {0.0, 1.0}, "1 sigma of odometry in a revolution, m a metre driven");
    v.field("odometry_rad", odometry_rad, {0.0, 1.0}, "1 sigma of odometry in a revolution, rad a rad turned");
    v.field("odometry_floor_m", odometry_floor_m, {1e-6, 1.0}, "m, 1 sigma, added for each scan");
    v.field("odometry_floor_rad", odometry_floor_rad, {1e-6, 1.0}, "rad, 1 sigma, added for each scan");
    v.field("min_match", min_match, {0.0, 1.0},
            "share of points that must match the map; with less the vehicle is lost");
    v.field("find_match", find_match, {0.0, 1.0}, "the same for a lost vehicle to be found");
    v.field("max_sigma", max_sigma, {0.01, 100.0}, "m, 1 sigma of the position above which the vehicle is lost");
  }
};

}  // namespace curbstone::localizer::tracking
