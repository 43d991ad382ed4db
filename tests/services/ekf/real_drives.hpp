#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/vehicle.hpp"
#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

/// IMU and wheels that others recorded, without truth. The imperfect ones are the point: nothing here is a fault.
struct RealDrive {
  Drive drive;
  VehicleConfig vehicle;  ///< measures with which wheels and IMU say the same
};

/// - robot: a robot of 10 cm that shakes and turns on the spot (../shared/data/lcm), 67 s. Its IMU comes at 20 Hz, with
///   pauses, and has no stamps but the log's; its wheels are stamped by their own clock.
/// - robot_by_the_log: the same, its wheels stamped by the log too: they come in bunches.
/// - race_car: a Formula Student car (../shared/data/can), 40 s with 0.4 g forward, 0.8 g of brakes and of bends, at up
///   to 70 km/h. Its motors' speeds come at 20 Hz, its IMU at 217 Hz. What a unit is, the log does not say: the wheels'
///   follows from the accelerometer, the gyro's from v w = a in bends, the track from both.
[[nodiscard]] const std::vector<std::string>& real_drive_names();
/// Nothing where the data are not there.
[[nodiscard]] std::optional<RealDrive> real_drive(const std::string& name);

}  // namespace curbstone::ekf
