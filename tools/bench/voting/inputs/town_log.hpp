#pragma once

#include <cstdint>
#include <string>

namespace curbstone::bench::voting::inputs {

/// Writes a drive through the demo town as a log: what `curbstone simulate --town --log FILE` does with its defaults.
/// Throws std::runtime_error when it cannot be written.
void record_town_log(std::uint64_t seed, double seconds, const std::string& file);

}  // namespace curbstone::bench::voting::inputs
