#pragma once

#include <functional>
#include <string>

#include "common/config/vehicle.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping::drives {

/// A drive for mapping: LiDAR revolutions, the odometry meanwhile, and the true poses.
class MappingDrive {
 public:
  /// One revolution, and odometry that reaches past its end (unless it has ended for good).
  using Take = std::function<void(const mapper::scan::Scan&, const mapper::scan::OdometryHistory&)>;

  virtual ~MappingDrive() = default;
  /// Plays the drive from its start, identically each time. Throws std::runtime_error if it cannot be read.
  virtual void play(const Take& take) const = 0;
  [[nodiscard]] virtual const evaluate::truth::Trajectory& truth()
      const = 0;  ///< T_world_base at some times; the choice of world is free

  std::string name;
  std::string prior = "none";  ///< source of the odometry: none, poor, ekf
  VehicleConfig vehicle;
  double ground = 0;  ///< m, height of the ground in base_link
};

}  // namespace curbstone::bench::mapping::drives
