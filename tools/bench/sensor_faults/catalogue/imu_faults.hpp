#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// An IMU in other units or axes than it should be, a gyro that fails, vibration, wrong stamps.
[[nodiscard]] std::vector<Fault> imu_faults();

}  // namespace curbstone::bench::sensor_faults::catalogue
