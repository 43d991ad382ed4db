#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// What moves with the vehicle or beside it and hides the street: no sensor is wrong.
[[nodiscard]] std::vector<Fault> surroundings_faults();

}  // namespace curbstone::bench::sensor_faults::catalogue
