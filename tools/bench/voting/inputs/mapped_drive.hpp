#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace curbstone::bench::voting::inputs {

/// The source of the points.
struct DriveSource {
  double seconds = 60;     ///< of the demo town, as of `curbstone simulate --town`
  std::uint64_t seed = 1;  ///< of the town and its drive
  std::string log;         ///< LCM log with LIDAR_POINTS, IMU and WHEELS to use instead, if not empty
};

/// Callbacks of a drive.
struct DriveListener {
  /// Every message that the mapper publishes, in encoded form.
  std::function<void(const std::string& channel, const void* data, int size)> message;
  /// Message time `now`, us: every 20 ms.
  std::function<void(std::int64_t now)> tick;
};

/// Plays a drive: sensors through filter and mapper, ticked as on the vehicle, in one thread and as fast as possible.
/// An emulated drive uses a log in the temporary folder (6 MB per second), which is removed. Throws std::runtime_error
/// if a log cannot be written or read.
void drive_and_map(const DriveSource& source, const DriveListener& listener);

}  // namespace curbstone::bench::voting::inputs
