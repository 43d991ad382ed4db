#pragma once

#include <string>
#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// All faults, by sensor. No two have the same name.
[[nodiscard]] std::vector<Fault> all_faults();

/// Those of `faults` of which "sensor: name" contains a match of the extended regular expression; all for an empty one.
/// Throws std::runtime_error if it is no regular expression, or if there is none.
[[nodiscard]] std::vector<Fault> named(std::vector<Fault> faults, const std::string& regex);

}  // namespace curbstone::bench::sensor_faults::catalogue
