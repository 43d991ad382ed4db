#pragma once

#include <functional>
#include <string>

#include "common/vehicle.hpp"
#include "services/mapper/odometry_history.hpp"
#include "services/mapper/revolution.hpp"
#include "tools/evaluate/trajectory.hpp"

namespace curbstone {

/// A drive to map: revolutions of a LiDAR, what odometry says meanwhile, and where the vehicle truly was.
class MappingDrive {
 public:
  /// One revolution, and odometry that has passed its end (or is silent for good).
  using Take = std::function<void(const Revolution&, const OdometryHistory&)>;

  virtual ~MappingDrive() = default;
  /// Plays the drive from its start; the same each time. Throws std::runtime_error when it cannot be read.
  virtual void play(const Take& take) const = 0;
  [[nodiscard]] virtual const Trajectory& truth() const = 0;  ///< T_world_base at some times, whatever the world

  std::string name;
  std::string prior = "none";  ///< where odometry comes from: none, poor, ekf
  VehicleConfig vehicle;
  double ground = 0;  ///< m, height of the ground in base_link
};

}  // namespace curbstone
