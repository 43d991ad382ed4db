#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::signals {

/// Position and scale of a number in a CAN frame. Bits are numbered as in a DBC file, for both byte orders: bit 8 *
/// byte + k, where k = 0 is the least significant. A little-endian (Intel) signal starts at its least significant bit.
/// A big-endian (Motorola) signal starts at its most significant bit, goes down within the byte, and continues at bit 7
/// of the next.
struct CanSignal {
  std::uint32_t id = 0;
  bool extended = false;  ///< the id has 29 bits
  int start = 0;          ///< bit
  int length = 32;        ///< bits, 1..64
  bool big_endian = false;
  bool is_signed = true;  ///< two's complement
  double factor = 1;      ///< value = raw * factor + offset
  double offset = 0;

  /// Parses "ID START|LENGTH@ORDER SIGN (FACTOR,OFFSET)", such as "181 0|32@1- (1,0)": the id in hexadecimal (8 digits:
  /// 29 bits; 0x may precede it), order 1 little-endian, 0 big-endian, sign - or +. (FACTOR,OFFSET) is optional. Throws
  /// std::runtime_error with a one-line message for anything else and for a signal that does not fit into 8 bytes.
  [[nodiscard]] static CanSignal parse(std::string_view text);

  [[nodiscard]] bool is_in(const can::CanFrame& frame) const { return frame.id == id && frame.extended == extended; }
  /// Sign-extended to 64 bits; nothing if the frame is too short or remote. The frame must have the signal's id.
  [[nodiscard]] std::optional<std::int64_t> raw(const can::CanFrame& frame) const;
  [[nodiscard]] double value(std::int64_t raw) const;
  /// Half of the number of its values: a counter that goes further seems to have gone back.
  [[nodiscard]] double half_range() const { return std::ldexp(1.0, length - 1); }
  /// Whether both signals share a bit of the same frame.
  [[nodiscard]] bool overlaps(const CanSignal& other) const;
};

}  // namespace curbstone::encoder::signals
