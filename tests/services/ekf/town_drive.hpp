#pragma once

#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

/// A drive round the block of a simulated town, with the simulator's own sensors, noise and slip events: what
/// `curbstone simulate --town` records of IMU and WHEELS, less the delays of their serial lines.
/// The vehicle's file may be as wrong about the vehicle as the options say.
struct TownDriveOptions {
  double seconds = 60.0;
  double speed = 3.0;                 ///< m/s
  unsigned seed = 1;                  ///< of the noise
  unsigned town = 1;                  ///< its number
  int imu_rate = 100;                 ///< Hz, a multiple of 100
  double gyro_noise = 0.0012;         ///< rad/s, 1 sigma of a sample
  double vibration = 0.12;            ///< m/s^2, likewise, while it rolls at 3 m/s
  bool slip = true;                   ///< with the simulator's slip events
  double scale = 0.0;                 ///< share by which both true wheels are larger than the vehicle's file says
  double track = 0.0;                 ///< likewise the track
  double axle = 0.0;                  ///< m, forward of base_link: where the wheels really are
  std::array<double, 2> course = {};  ///< rad, to the left and up of base_link's x: which way they really roll
};
[[nodiscard]] Drive simulate_town_drive(const TownDriveOptions& options, const VehicleConfig& vehicle);

}  // namespace curbstone::ekf
