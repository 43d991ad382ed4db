#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// Another device of the kind publishes on a sensor's channel: a second driver, or another vehicle on the bus.
[[nodiscard]] std::vector<Fault> second_sender_faults();

}  // namespace curbstone::bench::sensor_faults::catalogue
