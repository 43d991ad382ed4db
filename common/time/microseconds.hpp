#pragma once

#include <cmath>
#include <cstdint>

namespace curbstone {

/// A duration of a configuration, in s, as a number of whole us: the nearest one, halves away from zero. Truncation
/// would make 0.251 s one microsecond short in one of seventy milliseconds, for most decimals are not exact in binary.
[[nodiscard]] inline std::int64_t microseconds(double seconds) {
  return std::llround(seconds * 1e6);
}

}  // namespace curbstone
