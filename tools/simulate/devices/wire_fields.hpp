#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace curbstone::simulate::devices {

/// Writes `value` into `size` bytes from `at` on, most significant byte first.
inline void put_big_endian(std::span<std::uint8_t> bytes, std::size_t at, std::size_t size, std::uint64_t value) {
  for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (size - 1 - i)));
}

/// The same, least significant byte first.
inline void put_little_endian(std::span<std::uint8_t> bytes, std::size_t at, std::size_t size, std::uint64_t value) {
  for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

/// A range in steps of `step` m; 0 (no return) if it does not fit 16 bits.
inline std::uint16_t range_steps(float range_m, double step) {
  const double steps = std::round(static_cast<double>(range_m) / step);
  return steps > 0 && steps <= 65535 ? static_cast<std::uint16_t>(steps) : std::uint16_t{0};
}

/// An azimuth in 0.01 deg, 0..35999.
inline std::uint16_t azimuth_steps(double azimuth_deg) {
  const double turns = azimuth_deg / 360.0;
  const auto steps = static_cast<int>(std::lround((turns - std::floor(turns)) * 36000.0));
  return static_cast<std::uint16_t>(steps % 36000);
}

}  // namespace curbstone::simulate::devices
