#pragma once

#include <cstdint>

#include "tools/simulate/world/shapes.hpp"

namespace curbstone::simulate::sensors {

/// How a LiDAR puts the power of an echo in a byte: by reflectivity, angle of incidence and, little, by range, as
/// devices do that make up for distance. With `ring_gains` every laser has a scale of its own: asphalt at 10 to 87 of
/// 255, part of it an offset, and 3 to 40 % of its returns are 0. The device is the same in every drive.
struct IntensityModel {
  bool ring_gains = true;
  double step = 1.0;  ///< of 255: what comes out is a multiple

  [[nodiscard]] std::uint8_t report(const world::Hit& hit, float reflectivity, int laser, std::uint64_t noise) const;
};

}  // namespace curbstone::simulate::sensors
