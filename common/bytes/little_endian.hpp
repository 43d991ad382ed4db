#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace curbstone {

/// The unsigned number in the first sizeof(Number) bytes of `bytes`, least significant byte first. `bytes` must be at
/// least that long.
template <std::unsigned_integral Number>
[[nodiscard]] constexpr Number read_little_endian(std::span<const std::uint8_t> bytes) {
  Number value = 0;
  for (std::size_t i = sizeof(Number); i-- > 0;) value = static_cast<Number>(value << 8 | bytes[i]);
  return value;
}

/// Writes `value` over the first sizeof(Number) bytes of `bytes`.
template <std::unsigned_integral Number>
constexpr void write_little_endian(std::span<std::uint8_t> bytes, Number value) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace curbstone
