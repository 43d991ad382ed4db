#pragma once

#include <array>
#include <cstddef>

namespace curbstone::calibrate {

/// What a residual is of, and so what its noise is in.
enum NoiseKind : std::size_t {
  kAlong,     ///< m, of the way in a piece of the drive
  kSideways,  ///< m
  kUpwards,   ///< m
  kTilt,      ///< rad
  kTurn,      ///< m that one wheel rolled more than the other
  kGyro,      ///< rad
  kSpeed,     ///< m/s
  kNoiseCount
};
/// 1 sigma of each kind.
using NoiseLevels = std::array<double, kNoiseCount>;

}  // namespace curbstone::calibrate
