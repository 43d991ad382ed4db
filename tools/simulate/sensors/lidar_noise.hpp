#pragma once

#include <cstdint>

#include "common/config/config.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"
#include "tools/simulate/world/shapes.hpp"

namespace curbstone::simulate::sensors {

/// How a LiDAR differs from a perfect ruler.
struct LidarNoise {
  double range_sigma = 0.01;        ///< m
  double drop_out = 0.01;           ///< share of the echoes that get lost whatever they come from
  double reach_at_20_percent = 80;  ///< m, on a target of 20 % reflectivity seen head-on
  double min_range = 0.4;           ///< m
  double mixed_pixels = 0.002;      ///< share of shots that fall short in front of something: dust, edges

  void visit(ConfigVisitor& v) {
    v.field("range_sigma", range_sigma, {0.0, 0.5}, "m, noise of one range");
    v.field("drop_out", drop_out, {0.0, 1.0}, "share of echoes lost at random");
    v.field("reach_at_20_percent", reach_at_20_percent, {1.0, 300.0}, "m, reach on a target of 20 % reflectivity");
    v.field("min_range", min_range, {0.0, 10.0}, "m, nothing is seen nearer");
    v.field("mixed_pixels", mixed_pixels, {0.0, 0.2}, "share of shots with a range between two surfaces");
  }

  /// The sensor's report of a hit, by the shot's own random bits.
  [[nodiscard]] devices::LidarShot report(const world::Hit& hit, std::uint64_t noise) const;
};

}  // namespace curbstone::simulate::sensors
