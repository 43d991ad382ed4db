#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// The clock that stamps all sensors' messages is set in mid-drive: no sensor is wrong, and none is wrong alone.
[[nodiscard]] std::vector<Fault> host_clock_faults();

}  // namespace curbstone::bench::sensor_faults::catalogue
