#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/bytes/little_endian.hpp"

namespace curbstone {

/// Kinds of records. https://mcap.dev/spec
enum class McapRecord : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

/// Appends MCAP's numbers and texts, little-endian.
class RecordBytes {
 public:
  static constexpr std::size_t kHead = 9;  ///< bytes of a record before its content

  template <std::unsigned_integral Number>
  RecordBytes& number(Number value) {
    std::array<std::uint8_t, sizeof value> bytes{};
    write_little_endian(std::span<std::uint8_t>(bytes), value);
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return *this;
  }
  RecordBytes& raw(std::string_view bytes) {
    bytes_.append(bytes);
    return *this;
  }
  /// Appends a text, a list or a map, preceded by its length in bytes.
  RecordBytes& text(std::string_view bytes) { return number(static_cast<std::uint32_t>(bytes.size())).raw(bytes); }
  /// Appends the header of a record with `length` bytes of content.
  RecordBytes& head(McapRecord kind, std::uint64_t length) {
    return number(static_cast<std::uint8_t>(kind)).number(length);
  }
  RecordBytes& record(McapRecord kind, const RecordBytes& content) {
    return head(kind, content.size()).raw(content.bytes());
  }

  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  std::string bytes_;
};

}  // namespace curbstone
