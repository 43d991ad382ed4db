#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// Section `vehicle` of the vehicle's file says wrongly where the sensors are and how large the wheels are. The sensors
/// of the drive are where the default VehicleConfig has them.
[[nodiscard]] std::vector<Fault> vehicle_file_faults();

}  // namespace curbstone::bench::sensor_faults::catalogue
