#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tools/simulate/rig/drive.hpp"

namespace curbstone::simulate {

/// What a recording came to.
struct Recorded {
  std::int64_t packets = 0;  ///< that the LiDAR sent
  std::int64_t lidar = 0;    ///< messages of each kind that its driver and the others made
  std::int64_t imu = 0;
  std::int64_t wheels = 0;
};

/// Emulates a drive as fast as it goes: the devices' bytes, through the drivers' own nodes, into an LCM log as
/// lcm-logger would have made it. Throws std::runtime_error when the log cannot be written.
Recorded record_drive(const rig::Drive& drive, const std::string& log_file);

/// The same into other hands, message by message: channel, bytes, and when the driver sent it (us).
using RecordSink = std::function<void(const std::string& channel, const void* data, int size, std::int64_t log_utime)>;
Recorded record_drive(const rig::Drive& drive, const RecordSink& sink);

}  // namespace curbstone::simulate
