#pragma once

#include <cstdint>

namespace curbstone {

/// Microseconds since the Unix epoch. Shells only: cores and nodes act on message time.
[[nodiscard]] std::int64_t wall_clock();

/// Microseconds since some start, never jumps: for timeouts and pacing in shells.
[[nodiscard]] std::int64_t steady_clock();

}  // namespace curbstone
