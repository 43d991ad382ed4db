#pragma once

#include <cstdint>
#include <string>

#include "common/bus.hpp"
#include "tools/log/log_writer.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/simulate_config.hpp"
#include "tools/simulate/surroundings.hpp"

namespace curbstone {

/// What one emulated drive is made of.
struct Drive {
  const Motion& motion;
  Surroundings& surroundings;
  const SimulateConfig& config;
  std::uint64_t seed = 1;
  std::int64_t start_utime = 0;
  double seconds = 60;
  double rpm = 1200;
};

/// What a recording came to.
struct Recorded {
  std::int64_t packets = 0;
  std::int64_t imu = 0;
  std::int64_t wheels = 0;
  std::int64_t messages = 0;
};

/// Emulates a drive as fast as it goes: the devices' bytes, through the drivers' own nodes, into an LCM log as
/// lcm-logger would have made it. Throws std::runtime_error when the log cannot be written.
Recorded record_drive(const Drive& drive, const std::string& log_file);

}  // namespace curbstone
