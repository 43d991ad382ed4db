#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// Encoders that are wired or set up wrongly, that fail, and wheels that slip.
[[nodiscard]] std::vector<Fault> wheel_faults();

}  // namespace curbstone::bench::sensor_faults::catalogue
