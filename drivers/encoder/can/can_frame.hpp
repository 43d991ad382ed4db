#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace curbstone::encoder::can {

/// One classical CAN frame from any source.
struct CanFrame {
  std::uint32_t id = 0;  ///< 11 bits, or 29 if `extended`; no flag bits
  bool extended = false;
  bool remote = false;    ///< a request for data: carries a size but no data
  std::uint8_t size = 0;  ///< 0..8
  std::array<std::uint8_t, 8> data{};

  /// A data frame with an 11-bit id.
  static CanFrame make(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    CanFrame frame;
    frame.id = id;
    for (const std::uint8_t byte : bytes) frame.data[frame.size++] = byte;
    return frame;
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {data.data(), remote ? 0u : size}; }
  bool operator==(const CanFrame&) const = default;
};

}  // namespace curbstone::encoder::can
