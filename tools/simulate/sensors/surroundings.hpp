#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::sensors {

/// One shot of one laser from the moving vehicle.
struct Shot {
  double t = 0;  ///< s since the drive began
  int laser = 0;
  double azimuth = 0;  ///< rad, clockwise from the lidar's x
  Eigen::Vector3d origin_world;
  Eigen::Vector3d direction_world;
  std::uint64_t noise = 0;  ///< random bits of this shot
};

/// The sensor's pose and field of view while it fires the shots of one packet.
struct PacketView {
  double t = 0;                           ///< s since the drive began, of the packet's centre
  Pose T_world_lidar = Pose::Identity();  ///< then
  double azimuth = 0;                     ///< rad, clockwise, of the first shot
  double azimuth_span = 0;                ///< rad, to the last
};

/// The world that the lasers hit: a town, or recorded scans. One thread.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  /// Call it once per packet, before its shots.
  virtual void prepare(const PacketView& view) = 0;
  /// The sensor's report: noise included, no return if there is no echo.
  [[nodiscard]] virtual devices::LidarShot measure(const Shot& shot) = 0;
};

}  // namespace curbstone::simulate::sensors
