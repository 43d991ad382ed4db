#pragma once

#include <cstdint>

namespace curbstone {

/// The sequence number `step` after this one: 0 follows 2^31 - 1, so that a driver that runs for years sends no
/// negative one. `step` >= 0.
[[nodiscard]] constexpr std::int32_t next_sequence_number(std::int32_t number, std::int64_t step = 1) {
  return static_cast<std::int32_t>((static_cast<std::uint64_t>(number) + static_cast<std::uint64_t>(step)) &
                                   0x7FFFFFFF);
}

}  // namespace curbstone
