#pragma once

#include <cstdint>

#include "common/config/config.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"
#include "tools/simulate/world/shapes.hpp"

namespace curbstone::simulate::sensors {

/// The errors of a LiDAR.
struct LidarNoise {
  double range_sigma = 0.01;        ///< m
  double drop_out = 0.01;           ///< share of the echoes that are lost at random, whatever the target
  double reach_at_20_percent = 80;  ///< m, on a target of 20 % reflectivity at normal incidence
  double min_range = 0.4;           ///< m
  double mixed_pixels = 0.002;      ///< share of shots with a range short of the target: dust, edges

  void visit(ConfigVisitor& v) {
    v.field("range_sigma", range_sigma, {0.0, 0.5}, "m, noise of one range");
    v.field("drop_out", drop_out, {0.0, 1.0}, "share of echoes lost at random");
    v.field("reach_at_20_percent", reach_at_20_percent, {1.0, 300.0}, "m, reach on a target of 20 % reflectivity");
    v.field("min_range", min_range, {0.0, 10.0}, "m, nothing is seen nearer");
    v.field("mixed_pixels", mixed_pixels, {0.0, 0.2}, "share of shots with a range between two surfaces");
  }

  /// The sensor's report of a hit, from the shot's own random bits.
  [[nodiscard]] devices::LidarShot report(const world::Hit& hit, std::uint64_t noise) const;
};

}  // namespace curbstone::simulate::sensors
