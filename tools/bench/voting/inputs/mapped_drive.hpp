#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace curbstone::bench::voting::inputs {

/// Where the points come from.
struct DriveSource {
  double seconds = 60;     ///< of the demo town, as `curbstone simulate --town` makes it
  std::uint64_t seed = 1;  ///< of the town and its drive
  std::string log;         ///< LCM log with LIDAR_POINTS, IMU and WHEELS to be taken instead, if given
};

/// What hears the drive.
struct DriveListener {
  /// Every message that the mapper publishes, as it is encoded.
  std::function<void(const std::string& channel, const void* data, int size)> message;
  /// Message time `now`, us: every 20 ms.
  std::function<void(std::int64_t now)> tick;
};

/// Drives: sensors through filter and mapper, ticked as on the vehicle, in one thread as fast as it goes. An emulated
/// drive goes through a log in the temporary folder (6 MB a second), which is removed. Throws std::runtime_error when a
/// log cannot be written or read.
void drive_and_map(const DriveSource& source, const DriveListener& listener);

}  // namespace curbstone::bench::voting::inputs
