#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace curbstone::encoder::can {

inline constexpr std::uint32_t kMaxStandardId = 0x7FF;
inline constexpr std::uint32_t kMaxExtendedId = 0x1FFFFFFF;

/// Parses all of `text` as a hexadecimal number of at most 8 digits; empty if it is not one.
[[nodiscard]] inline std::optional<std::uint32_t> parse_hex(std::string_view text) {
  std::uint32_t value = 0;
  if (text.empty() || text.size() > 8) return {};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

/// Parses two digits per byte into the front of `bytes`; false if the text is anything else.
[[nodiscard]] inline bool parse_hex_bytes(std::string_view text, std::span<std::uint8_t> bytes) {
  if (text.size() % 2 != 0 || text.size() / 2 > bytes.size()) return false;
  for (std::size_t i = 0; i < text.size() / 2; ++i) {
    const auto byte = parse_hex(text.substr(2 * i, 2));
    if (!byte) return false;
    bytes[i] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

}  // namespace curbstone::encoder::can
