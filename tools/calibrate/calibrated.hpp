#pragma once

#include <cstddef>

namespace curbstone::calibrate {

/// The estimated parameters, in this order. Lengths in m, angles in rad (roll, pitch, yaw about fixed axes).
enum class Calibrated : int {
  kRadiusLeft,
  kRadiusRight,
  kTrack,
  kLidarX,
  kLidarY,
  kLidarZ,
  kLidarRoll,
  kLidarPitch,
  kLidarYaw,
  kImuX,
  kImuY,
  kImuZ,
  kImuRoll,
  kImuPitch,
  kImuYaw,
  kCount,
};
inline constexpr std::size_t kCalibratedCount = static_cast<std::size_t>(Calibrated::kCount);

}  // namespace curbstone::calibrate
