#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace curbstone {

/// The unsigned number in the first bytes of `bytes`, most significant byte first, as all numbers on Xbus.
template <std::unsigned_integral Number>
[[nodiscard]] constexpr Number big_endian(std::span<const std::uint8_t> bytes) {
  Number value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) value = static_cast<Number>(value << 8 | bytes[i]);
  return value;
}

template <std::unsigned_integral Number>
void append_big_endian(std::vector<std::uint8_t>& bytes, Number value) {
  for (std::size_t i = sizeof(Number); i-- > 0;) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

}  // namespace curbstone
