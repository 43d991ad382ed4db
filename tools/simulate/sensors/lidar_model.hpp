#pragma once

#include <cstdint>

#include "common/config/vehicle.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/sensors/surroundings.hpp"

namespace curbstone::simulate::sensors {

/// Fires the lasers of an RS16 one by one from the moving vehicle and packs what comes back. Packets follow each other
/// without a gap.
class LidarModel {
 public:
  struct Options {
    double rpm = 1200;
    std::uint64_t seed = 1;
    double azimuth = 0;            ///< deg, clockwise, at t = 0
    std::int64_t start_utime = 0;  ///< us, of t = 0
  };
  struct Packet {
    double t = 0;       ///< s, of its first shot
    double t_last = 0;  ///< s, of its last: when it can be sent
    lidar::models::rs16::Rs16Packet bytes{};
  };

  LidarModel(const Options& options, const VehicleConfig& vehicle, const motion::Motion& motion,
             Surroundings& surroundings);

  /// The next packet; the first starts at t = 0.
  Packet next();
  /// Goes on with the packet of that number: packets do not depend on those before.
  void skip_to(std::int64_t packet) { sequence_ = packet * lidar::models::rs16::kSequencesPerPacket; }
  [[nodiscard]] lidar::models::rs16::Rs16Packet difop(double t) const;

 private:
  Options options_;
  Pose T_base_lidar_;
  const motion::Motion& motion_;
  Surroundings& surroundings_;
  devices::Rs16Emulator emulator_;
  std::int64_t sequence_ = 0;
};

}  // namespace curbstone::simulate::sensors
