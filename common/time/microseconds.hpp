#pragma once

#include <cmath>
#include <cstdint>

namespace curbstone {

/// A configured duration in s as a whole number of us: the nearest one, halves away from zero. Most decimals are not
/// exact in binary: truncation would make one in seventy of the whole milliseconds, 0.251 s for example, one
/// microsecond short.
[[nodiscard]] inline std::int64_t microseconds(double seconds) {
  return std::llround(seconds * 1e6);
}

}  // namespace curbstone
