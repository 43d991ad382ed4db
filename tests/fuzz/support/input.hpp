#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace curbstone::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// The fuzzer's bytes, taken from the front. Any bytes mean something, so that no mutation is wasted: numbers are zero
/// and pieces are short where the bytes end.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  /// As it lies in memory, little-endian.
  template <class Number>
  Number number() {
    Number value{};
    const Bytes bytes = take(sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), bytes.size());
    return value;
  }
  Bytes take(std::size_t size) {
    const Bytes bytes = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(bytes.size());
    return bytes;
  }
  /// Two bytes of length, then so many bytes.
  Bytes piece() { return take(number<std::uint16_t>()); }
  Bytes rest() { return take(rest_.size()); }

 private:
  Bytes rest_;
};

[[nodiscard]] inline std::string_view text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace curbstone::fuzz
