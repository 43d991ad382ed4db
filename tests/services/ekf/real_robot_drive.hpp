#pragma once

#include <optional>

#include "common/config/vehicle.hpp"
#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

/// IMU and wheels of a real robot of 8 cm between its wheels, 69 s, from ../shared/data/lcm; no truth. The stamps are
/// those of the log. Sets `vehicle` to its measures. Nothing where the data are not there.
[[nodiscard]] std::optional<Drive> real_robot_drive(VehicleConfig& vehicle);

}  // namespace curbstone::ekf
