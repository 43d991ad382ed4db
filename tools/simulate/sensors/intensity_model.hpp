#pragma once

#include <cstdint>

#include "tools/simulate/world/shapes.hpp"

namespace curbstone::simulate::sensors {

/// Maps the power of an echo to a byte: by reflectivity, angle of incidence and, weakly, range, like devices that
/// compensate for distance. With `ring_gains` every laser has its own scale: asphalt at 10 to 87 of 255, part of it an
/// offset, and 3 to 40 % of its returns are 0. The device is the same in every drive.
struct IntensityModel {
  bool ring_gains = true;
  double step = 1.0;  ///< of 255: the result is a multiple of it

  [[nodiscard]] std::uint8_t report(const world::Hit& hit, float reflectivity, int laser, std::uint64_t noise) const;
};

}  // namespace curbstone::simulate::sensors
