#pragma once

#include <cstdint>

namespace curbstone {

/// Whether `period` has passed from `since` to `now`, us, by a clock that somebody may set. Set back, it has: what is
/// done once in a while must not wait until the clock shows the old time again.
[[nodiscard]] constexpr bool has_passed(std::int64_t period, std::int64_t since, std::int64_t now) {
  return now < since || now - since >= period;
}

}  // namespace curbstone
