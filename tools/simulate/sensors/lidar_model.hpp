#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/config/vehicle.hpp"
#include "tools/simulate/devices/make_lidar.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/sensors/surroundings.hpp"

namespace curbstone::simulate::sensors {

/// Fires the lasers of a LiDAR one by one from the moving vehicle and packs the returns. Packets follow each other
/// without a gap.
class LidarModel {
 public:
  struct Options {
    double rpm = 1200;
    std::uint64_t seed = 1;
    double azimuth = 0;            ///< deg, clockwise, at t = 0
    std::int64_t start_utime = 0;  ///< us, of t = 0
    devices::LidarName lidar = devices::LidarName::kRs16;
  };
  struct Packet {
    double t = 0;       ///< s, of its first shot
    double t_last = 0;  ///< s, of its last shot, after which it can be sent
    std::vector<std::uint8_t> bytes;
  };

  LidarModel(const Options& options, const VehicleConfig& vehicle, const motion::Motion& motion,
             Surroundings& surroundings);

  /// The next packet; the first starts at t = 0.
  Packet next();
  /// Continues with the packet of that number: packets do not depend on earlier ones.
  void skip_to(std::int64_t packet) { firing_ = packet * device_->table().firings_per_packet; }
  /// The device information packet at t.
  [[nodiscard]] std::vector<std::uint8_t> info(double t) const;
  [[nodiscard]] const devices::LidarTable& table() const { return device_->table(); }

 private:
  Options options_;
  Pose T_base_lidar_;
  const motion::Motion& motion_;
  Surroundings& surroundings_;
  std::unique_ptr<devices::LidarEmulator> device_;
  std::vector<devices::LidarRay> rays_;  ///< of one firing
  std::vector<devices::LidarShot> shots_;
  std::int64_t firing_ = 0;
};

}  // namespace curbstone::simulate::sensors
