#pragma once

#include <cstdint>
#include <string>

namespace curbstone::bench::voting::inputs {

/// Records a drive through the demo town as a log, like `curbstone simulate --town --log FILE` with its defaults.
/// Throws std::runtime_error if it cannot be written.
void record_town_log(std::uint64_t seed, double seconds, const std::string& file);

}  // namespace curbstone::bench::voting::inputs
