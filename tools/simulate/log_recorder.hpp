#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tools/simulate/rig/drive.hpp"

namespace curbstone::simulate {

/// Counts of a recording.
struct Recorded {
  std::int64_t packets = 0;  ///< of the LiDAR
  std::int64_t lidar = 0;    ///< messages of the LiDAR's driver, and below of the other drivers
  std::int64_t imu = 0;
  std::int64_t wheels = 0;
};

/// Emulates a drive as fast as possible: passes the devices' bytes through the drivers' own nodes into an LCM log as
/// lcm-logger writes it. Throws std::runtime_error if the log cannot be written.
Recorded record_drive(const rig::Drive& drive, const std::string& log_file);

/// The same into a callback, message by message: channel, bytes, and when the driver sent it (us).
using RecordSink = std::function<void(const std::string& channel, const void* data, int size, std::int64_t log_utime)>;
Recorded record_drive(const rig::Drive& drive, const RecordSink& sink);

}  // namespace curbstone::simulate
