#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::signals {

/// Where a number is in a CAN frame. Bits are numbered as in a DBC file, for both byte orders: bit 8 * byte + k, k = 0
/// the least. A little-endian (Intel) signal starts at its least bit. A big-endian (Motorola) one starts at its
/// greatest, goes down inside the byte, and on at bit 7 of the next.
struct CanSignal {
  std::uint32_t id = 0;
  bool extended = false;  ///< the id has 29 bits
  int start = 0;          ///< bit
  int length = 32;        ///< bits, 1..64
  bool big_endian = false;
  bool is_signed = true;  ///< two's complement
  double factor = 1;      ///< value = raw * factor + offset
  double offset = 0;

  /// "ID START|LENGTH@ORDER SIGN (FACTOR,OFFSET)", as "181 0|32@1- (1,0)": the id in hexadecimal (8 digits: 29 bits),
  /// order 1 little-endian, 0 big-endian, sign - or +. (FACTOR,OFFSET) may be left out. Throws std::runtime_error, with
  /// one clear line, for anything else and for a signal that does not fit into 8 bytes.
  [[nodiscard]] static CanSignal parse(std::string_view text);

  [[nodiscard]] bool is_in(const can::CanFrame& frame) const { return frame.id == id && frame.extended == extended; }
  /// Extended to 64 bits by its sign; nothing if the frame is too short, or remote. The frame must be the signal's.
  [[nodiscard]] std::optional<std::int64_t> raw(const can::CanFrame& frame) const;
  [[nodiscard]] double value(std::int64_t raw) const;
  /// Whether a bit of the same frame belongs to both.
  [[nodiscard]] bool overlaps(const CanSignal& other) const;
};

}  // namespace curbstone::encoder::signals
