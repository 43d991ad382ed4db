#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/bytes/little_endian.hpp"

namespace curbstone::viewer::frames {

/// Appends numbers in little-endian byte order.
class ByteWriter {
 public:
  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void i8(std::int8_t value) { u8(static_cast<std::uint8_t>(value)); }
  void u16(std::uint16_t value) { write(value); }
  void i16(std::int16_t value) { write(static_cast<std::uint16_t>(value)); }
  void u32(std::uint32_t value) { write(value); }
  void i32(std::int32_t value) { write(static_cast<std::uint32_t>(value)); }
  void f32(float value) { write(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { write(std::bit_cast<std::uint64_t>(value)); }
  void bytes(std::span<const std::uint8_t> more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }
  void text(std::string_view more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }

  /// Overwrites a number that is known only after the bytes that follow it were written.
  void set_u32(std::size_t place, std::uint32_t value) {
    write_little_endian(std::span<std::uint8_t>(bytes_).subspan(place), value);
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] const std::vector<std::uint8_t>& written() const { return bytes_; }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  template <class Number>
  void write(Number value) {
    const std::size_t place = bytes_.size();
    bytes_.resize(place + sizeof value);
    write_little_endian(std::span<std::uint8_t>(bytes_).subspan(place), value);
  }
  std::vector<std::uint8_t> bytes_;
};

}  // namespace curbstone::viewer::frames
