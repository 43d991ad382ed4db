#pragma once

#include <cstdint>

namespace curbstone {

/// Unsigned numbers as a wire carries them, most significant byte first. They have alignment 1, so that a packet's
/// struct is its layout, and the byte swapping is in the type instead of in the code.
struct Be16 {
  std::uint8_t bytes[2] = {};

  constexpr Be16() = default;
  constexpr Be16(std::uint16_t value)  // NOLINT(google-explicit-constructor): stands for the number
      : bytes{static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)} {}
  constexpr operator std::uint16_t() const { return static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]); }
};

struct Be24 {
  std::uint8_t bytes[3] = {};

  constexpr Be24() = default;
  constexpr Be24(std::uint32_t value)  // NOLINT(google-explicit-constructor)
      : bytes{static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
              static_cast<std::uint8_t>(value)} {}
  constexpr operator std::uint32_t() const {
    return static_cast<std::uint32_t>(bytes[0]) << 16 | static_cast<std::uint32_t>(bytes[1]) << 8 | bytes[2];
  }
};

}  // namespace curbstone
