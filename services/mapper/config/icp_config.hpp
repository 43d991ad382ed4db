#pragma once

#include "common/config/config.hpp"

namespace curbstone::mapper::config {

/// Settings of point-to-plane registration.
struct IcpConfig {
  double source_voxel = 0.10;
  double max_range = 60.0;
  double window = 80.0;
  double fine_voxel = 0.30;
  double coarse_voxel = 1.0;
  double sensor_sigma = 0.02;
  double kernel = 0.03;
  double search = 0.5;
  double min_grazing = 0.05;
  int max_iterations = 20;
  double degenerate_below = 0.004;

  void visit(ConfigVisitor& v) {
    v.field("source_voxel", source_voxel, {0.02, 2.0},
            "m, the scan is thinned to one point per voxel; dense is better with 16 beams");
    v.field("max_range", max_range, {2.0, 200.0}, "m, farther points are not used");
    v.field("window", window, {10.0, 500.0}, "m, half size of the registration map around the vehicle");
    v.field("fine_voxel", fine_voxel, {0.05, 2.0}, "m, of the planes");
    v.field("coarse_voxel", coarse_voxel, {0.1, 10.0}, "m, of the planes where points are too sparse for fine ones");
    v.field("sensor_sigma", sensor_sigma, {0.001, 0.5}, "m, noise of a range");
    v.field("kernel", kernel, {0.005, 1.0}, "m, bound of the Huber kernel, near the noise of the sensor");
    v.field("search", search, {0.05, 5.0},
            "m, search distance to a plane in the first iteration, if the prior is poor");
    v.field("min_grazing", min_grazing, {0.0, 0.5},
            "sine of the mean angle between rays and a plane; with less it is no surface");
    v.field("max_iterations", max_iterations, {1, 200}, "Gauss-Newton iterations");
    v.field("degenerate_below", degenerate_below, {0.0, 0.5},
            "share of the constraint below which a direction is degenerate and follows the prior");
  }
};

}  // namespace curbstone::mapper::config
