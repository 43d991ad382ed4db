#pragma once

#include <array>
#include <cstddef>

namespace curbstone::calibrate {

/// Kinds of residuals, each with its own noise level and unit.
enum NoiseKind : std::size_t {
  kAlong,     ///< m, longitudinal, over a piece of the drive
  kSideways,  ///< m
  kUpwards,   ///< m
  kTilt,      ///< rad
  kTurn,      ///< m, difference of the wheels' paths
  kGyro,      ///< rad
  kSpeed,     ///< m/s
  kNoiseCount
};
/// 1 sigma of each kind.
using NoiseLevels = std::array<double, kNoiseCount>;

}  // namespace curbstone::calibrate
