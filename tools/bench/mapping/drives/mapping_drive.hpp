#pragma once

#include <functional>
#include <string>

#include "common/config/vehicle.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping::drives {

/// A drive to map: revolutions of a LiDAR, what odometry says meanwhile, and where the vehicle truly was.
class MappingDrive {
 public:
  /// One revolution, and odometry that has passed its end (or is silent for good).
  using Take = std::function<void(const mapper::scan::Scan&, const mapper::scan::OdometryHistory&)>;

  virtual ~MappingDrive() = default;
  /// Plays the drive from its start; the same each time. Throws std::runtime_error when it cannot be read.
  virtual void play(const Take& take) const = 0;
  [[nodiscard]] virtual const evaluate::truth::Trajectory& truth()
      const = 0;  ///< T_world_base at some times, whatever the world

  std::string name;
  std::string prior = "none";  ///< where odometry comes from: none, poor, ekf
  VehicleConfig vehicle;
  double ground = 0;  ///< m, height of the ground in base_link
};

}  // namespace curbstone::bench::mapping::drives
