#include "drivers/encoder/can/candump.hpp"

#include <array>
#include <charconv>
#include <chrono>
#include <span>

#include "drivers/encoder/can/hex.hpp"

namespace curbstone::encoder::can {

namespace {

std::optional<std::int64_t> parse_decimal(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || text[0] == '-' || error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

/// "318981", one to nine digits: python-can and candump -N write others than six. In us.
std::optional<std::int64_t> parse_fraction(std::string_view text) {
  constexpr std::size_t kMicros = 6;
  if (text.size() > 9 || !parse_decimal(text)) return {};
  std::string micros(text.substr(0, kMicros));
  micros.resize(kMicros, '0');
  return parse_decimal(micros);
}

/// "2020-12-15 18:12:54", in s since the Unix epoch.
std::optional<std::int64_t> parse_date(std::string_view text) {
  if (text.size() != 19 || text[4] != '-' || text[7] != '-' || text[10] != ' ' || text[13] != ':' || text[16] != ':')
    return {};
  const auto year = parse_decimal(text.substr(0, 4));
  const auto month = parse_decimal(text.substr(5, 2));
  const auto day = parse_decimal(text.substr(8, 2));
  const auto hour = parse_decimal(text.substr(11, 2));
  const auto minute = parse_decimal(text.substr(14, 2));
  const auto second = parse_decimal(text.substr(17, 2));
  if (!year || !month || !day || !hour || !minute || !second || *hour > 23 || *minute > 59 || *second > 60) return {};
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(*year)),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day)));
  if (!date.ok()) return {};
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  return ((days * 24 + *hour) * 60 + *minute) * 60 + *second;
}

/// "1608055974.318981", "000.012345" or "2020-12-15 18:12:54.318981", in us.
std::optional<std::int64_t> parse_stamp(std::string_view text) {
  const std::size_t dot = text.find('.');
  if (dot == std::string_view::npos) return {};
  const std::string_view whole = text.substr(0, dot);
  const auto seconds = whole.find('-') != std::string_view::npos ? parse_date(whole)
                       : dot <= 12                               ? parse_decimal(whole)
                                                                 : std::nullopt;
  const auto micros = parse_fraction(text.substr(dot + 1));
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

/// What candump shows behind the interface: "202   [8]  90 3C ...", "12345678   [0]  remote request", and with -x
/// before it "TX - -". Of CAN FD the length has two digits.
std::optional<CandumpLine> parse_shown(std::string_view word, std::string_view rest) {
  if (word == "TX" || word == "RX") {
    for (int flags = 0; flags < 2; ++flags) {
      if (next_word(rest).size() != 1) return {};
    }
    word = next_word(rest);
  }
  CandumpLine line;
  const auto id = word.size() < 3 ? std::nullopt : parse_hex(word);
  std::string_view length = next_word(rest);
  if (!id || length.size() < 3) return {};
  const bool code = length.front() == '{';  // candump -8: a length code above 8 of a frame of 8 bytes
  if (length.back() != (code ? '}' : ']') || (!code && length.front() != '[')) return {};
  length = length.substr(1, length.size() - 2);
  const auto number = code ? std::optional<std::int64_t>(8) : parse_decimal(length);
  if (!number || length.size() > 4) return {};
  // Older versions write a 29-bit id without leading zeros.
  line.frame.extended = word.size() > 3;
  constexpr std::uint32_t kErrorFlag = 0x20000000;
  line.other = length.size() > 1 || (*id & kErrorFlag) != 0;
  if (line.other) return line;
  if (*id > (line.frame.extended ? kMaxExtendedId : kMaxStandardId) || *number > 8) return {};
  line.frame.id = *id;
  line.frame.size = static_cast<std::uint8_t>(*number);
  std::string_view after = rest;
  if (next_word(after) == "remote" && next_word(after) == "request") {
    line.frame.remote = true;
    return line;
  }
  for (std::size_t i = 0; i < line.frame.size; ++i) {
    const std::string_view byte = next_word(rest);
    if (byte.size() != 2 || !parse_hex_bytes(byte, std::span(line.frame.data).subspan(i, 1))) return {};
  }
  const std::string_view end = next_word(rest);
  if (!end.empty() && end.front() != '\'') return {};  // -a: the bytes as text
  return line;
}

}  // namespace

std::optional<CandumpLine> parse_candump_line(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t\r");
  const std::size_t end = line.find(')');
  if (begin == std::string_view::npos || line[begin] != '(' || end == std::string_view::npos) return {};
  const auto utime = parse_stamp(line.substr(begin + 1, end - begin - 1));
  line.remove_prefix(end + 1);
  if (!utime || line.empty() || (line[0] != ' ' && line[0] != '\t')) return {};
  const std::string interface(next_word(line));
  const std::string_view frame_text = next_word(line);
  if (frame_text.find('#') == std::string_view::npos) {
    auto shown = parse_shown(frame_text, line);
    if (!shown) return {};
    shown->utime = *utime;
    shown->interface = interface;
    return shown;
  }
  const std::string_view direction = next_word(line);  // newer versions of candump add T or R
  if (!direction.empty() && direction != "T" && direction != "R") return {};
  if (is_other(frame_text)) return CandumpLine{*utime, interface, {}, true};
  const auto frame = parse_frame(frame_text);
  if (!frame) return {};
  return CandumpLine{*utime, interface, *frame};
}

bool is_candump_without_time(std::string_view line) {
  const std::string_view interface = next_word(line);
  if (interface.empty() || interface[0] == '(') return false;
  const std::string_view word = next_word(line);
  return parse_shown(word, line).has_value();
}

}  // namespace curbstone::encoder::can
