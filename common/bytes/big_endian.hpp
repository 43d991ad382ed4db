#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace curbstone {

/// The unsigned number in the first sizeof(Number) bytes of `bytes`, most significant byte first: network byte order.
/// `bytes` must be at least that long.
template <std::unsigned_integral Number>
[[nodiscard]] constexpr Number read_big_endian(std::span<const std::uint8_t> bytes) {
  Number value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) value = static_cast<Number>(value << 8 | bytes[i]);
  return value;
}

/// Appends the sizeof(Number) bytes of `value`, most significant first.
template <std::unsigned_integral Number>
void append_big_endian(std::vector<std::uint8_t>& bytes, Number value) {
  for (std::size_t i = sizeof(Number); i-- > 0;) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// A field of a packet: an unsigned number in kSize bytes, most significant first. It has alignment 1, so a struct of
/// such fields is the layout of the packet. The type swaps the bytes, so the code that reads the packet need not.
template <std::unsigned_integral Number, std::size_t kSize = sizeof(Number)>
struct BigEndian {
  static_assert(kSize <= sizeof(Number));
  std::uint8_t bytes[kSize] = {};

  constexpr BigEndian() = default;
  constexpr BigEndian(Number value) {  // NOLINT(google-explicit-constructor): stands for the number
    for (std::size_t i = 0; i < kSize; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * (kSize - 1 - i)));
  }
  constexpr operator Number() const {  // NOLINT(google-explicit-constructor)
    Number value = 0;
    for (const std::uint8_t byte : bytes) value = static_cast<Number>(value << 8 | byte);
    return value;
  }
};
using Be16 = BigEndian<std::uint16_t>;
using Be24 = BigEndian<std::uint32_t, 3>;

}  // namespace curbstone
