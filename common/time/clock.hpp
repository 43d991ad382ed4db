#pragma once

#include <cstdint>

namespace curbstone {

/// us since the Unix epoch. For shells only: cores and nodes act on message time. It may jump when the host's clock is
/// set.
[[nodiscard]] std::int64_t wall_clock();

/// us since an arbitrary start; never jumps. For time-outs and pacing in shells.
[[nodiscard]] std::int64_t steady_clock();

}  // namespace curbstone
