#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::sensors {

/// One shot of one laser, as it really leaves the moving vehicle.
struct Shot {
  double t = 0;  ///< s since the drive began
  int laser = 0;
  double azimuth = 0;  ///< rad, clockwise from the lidar's x
  Eigen::Vector3d origin_world;
  Eigen::Vector3d direction_world;
  std::uint64_t noise = 0;  ///< this shot's own random bits
};

/// Where the sensor is and looks while it fires the shots of one packet.
struct PacketView {
  double t = 0;                           ///< s since the drive began, of the packet's middle
  Pose T_world_lidar = Pose::Identity();  ///< then
  double azimuth = 0;                     ///< rad, clockwise, of the first shot
  double azimuth_span = 0;                ///< rad, to the last
};

/// What the lasers meet: a town, or what a recorded scan shows. One thread.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  /// Once for every packet, before its shots.
  virtual void prepare(const PacketView& view) = 0;
  /// What the sensor reports: noise included, nothing if there is no echo.
  [[nodiscard]] virtual devices::LidarShot measure(const Shot& shot) = 0;
};

}  // namespace curbstone::simulate::sensors
