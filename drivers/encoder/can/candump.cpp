#include "drivers/encoder/can/candump.hpp"

#include <array>
#include <charconv>

#include "drivers/encoder/can/hex.hpp"

namespace curbstone::encoder::can {

namespace {

std::optional<std::int64_t> parse_decimal(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || text[0] == '-' || error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

/// "1608055974.318981"
std::optional<std::int64_t> parse_stamp(std::string_view text) {
  const std::size_t dot = text.find('.');
  if (dot == std::string_view::npos || dot > 12 || text.size() - dot != 7) return {};
  const auto seconds = parse_decimal(text.substr(0, dot));
  const auto micros = parse_decimal(text.substr(dot + 1));
  if (!seconds || !micros) return {};
  return *seconds * 1'000'000 + *micros;
}

/// "202##1AABB": flags, data; "20000088#00": an error, marked by bit 29
bool is_other(std::string_view text) {
  constexpr std::uint32_t kError = 0x20000000;
  constexpr std::size_t kMaxData = 64;
  const std::size_t hash = text.find('#');
  if (hash != 3 && hash != 8) return false;
  const auto id = parse_hex(text.substr(0, hash));
  const bool error = hash == 8 && id && (*id & ~kMaxExtendedId) == kError;
  if (!id || (!error && *id > (hash == 8 ? kMaxExtendedId : kMaxStandardId))) return false;
  std::string_view payload = text.substr(hash + 1);
  const bool fd = !error && payload.starts_with('#') && payload.size() >= 2 && parse_hex(payload.substr(1, 1));
  if (fd) payload.remove_prefix(2);
  std::array<std::uint8_t, kMaxData> data;
  return (fd || error) && parse_hex_bytes(payload, data);
}

/// "1122334455667788_E", "R8_9": eight bytes whose length code is above 8 (candump -8).
void drop_length_code(std::string_view& payload) {
  if (payload.size() < 2 || payload[payload.size() - 2] != '_') return;
  const auto code = parse_hex(payload.substr(payload.size() - 1));
  const std::string_view rest = payload.substr(0, payload.size() - 2);
  if (code && *code > 8 && (rest.size() == 16 || rest == "R8")) payload = rest;
}

/// "202#903C", "00000123#", "123#R", "123#R4"
std::optional<CanFrame> parse_frame(std::string_view text) {
  const std::size_t hash = text.find('#');
  if (hash != 3 && hash != 8) return {};
  CanFrame frame;
  frame.extended = hash == 8;
  const auto id = parse_hex(text.substr(0, hash));
  if (!id || *id > (frame.extended ? kMaxExtendedId : kMaxStandardId)) return {};
  frame.id = *id;
  std::string_view payload = text.substr(hash + 1);
  drop_length_code(payload);
  if (!payload.empty() && payload[0] == 'R') {
    frame.remote = true;
    if (payload.size() > 2) return {};
    if (payload.size() == 2) {
      if (payload[1] < '0' || payload[1] > '8') return {};
      frame.size = static_cast<std::uint8_t>(payload[1] - '0');
    }
    return frame;
  }
  if (!parse_hex_bytes(payload, frame.data)) return {};
  frame.size = static_cast<std::uint8_t>(payload.size() / 2);
  return frame;
}

/// Removes and returns the first word.
std::string_view next_word(std::string_view& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return text = {};
  text.remove_prefix(begin);
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace

std::optional<CandumpLine> parse_candump_line(std::string_view line) {
  const std::string_view stamp = next_word(line);
  const std::string_view interface = next_word(line);
  const std::string_view frame_text = next_word(line);
  if (stamp.size() < 3 || stamp.front() != '(' || stamp.back() != ')' || interface.empty()) return {};
  const std::string_view direction = next_word(line);  // newer versions of candump add T or R
  if (!direction.empty() && direction != "T" && direction != "R") return {};
  const auto utime = parse_stamp(stamp.substr(1, stamp.size() - 2));
  if (!utime) return {};
  if (is_other(frame_text)) return CandumpLine{*utime, std::string(interface), {}, true};
  const auto frame = parse_frame(frame_text);
  if (!frame) return {};
  return CandumpLine{*utime, std::string(interface), *frame};
}

}  // namespace curbstone::encoder::can
