#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "tools/simulate/devices/make_lidar.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/rig/simulate_config.hpp"
#include "tools/simulate/sensors/surroundings.hpp"

namespace curbstone::simulate::rig {

/// The parts of one emulated drive, for live sending or for a log.
struct Drive {
  const motion::Motion& motion;
  std::function<std::unique_ptr<sensors::Surroundings>()> make_surroundings;  ///< one per thread that casts rays
  const SimulateConfig& config;
  double rpm = 1200;
  double azimuth = 0;  ///< deg, clockwise, of the LiDAR's head at t = 0
  std::uint64_t seed = 1;
  double seconds = 60;
  std::int64_t start_utime = 0;  ///< us since the Unix epoch, of t = 0
  devices::LidarName lidar = devices::LidarName::kRs16;
};

}  // namespace curbstone::simulate::rig
