#include "drivers/encoder/traces/pcan_trace.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "drivers/encoder/can/hex.hpp"

namespace curbstone::encoder::traces {

namespace {

constexpr double kEpochDay = 25569;  // 1970-01-01, in days since 1899-12-30
constexpr double kMaxDays = 100'000;
constexpr double kMaxOffset = 1e12;  // ms: 30 years
constexpr std::size_t kMaxColumns = 16;

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// Removes and returns the first word; empty at the end.
std::string_view next_word(std::string_view& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  text.remove_prefix(begin == std::string_view::npos ? text.size() : begin);
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
  text.remove_prefix(word.size());
  return word;
}

bool parse_id(std::string_view text, can::CanFrame& frame) {
  const auto id = can::parse_hex(text);
  frame.extended = text.size() == 8;
  if (!id || (text.size() > 4 && !frame.extended)) return false;
  frame.id = *id;
  return *id <= (frame.extended ? can::kMaxExtendedId : can::kMaxStandardId);
}

bool parse_data(std::string_view rest, can::CanFrame& frame) {
  for (std::size_t i = 0; i < frame.size; ++i) {
    const std::string_view word = next_word(rest);
    if (word.size() != 2 || !can::parse_hex_bytes(word, std::span(frame.data).subspan(i, 1))) return false;
  }
  return next_word(rest).empty();
}

enum class Type { kData, kRemote, kOther };

Type type_of(std::string_view word, bool old) {
  if (old) return word == "Rx" || word == "Tx" ? Type::kData : Type::kOther;
  return word == "DT" ? Type::kData : word == "RR" ? Type::kRemote : Type::kOther;
}

}  // namespace

void PcanTrace::on_keyword(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return;
  const std::string_view key = line.substr(0, equals);
  std::string_view rest = line.substr(equals + 1);
  const std::string_view value = next_word(rest);
  if (key == ";$FILEVERSION") {
    old_ = value == "1.1";
    foreign_version_ = old_ || value == "2.0" || value == "2.1" ? "" : std::string(value.substr(0, 20));
    columns_ = old_ ? "NOTILD" : value == "2.0" ? "NOTIdlD" : "NOTBIdRLD";
  } else if (key == ";$STARTTIME") {
    const auto days = parse_number(value);
    if (days && *days >= kEpochDay && *days <= kMaxDays) start_ = std::llround((*days - kEpochDay) * 86400e6);
  } else if (key == ";$COLUMNS") {
    columns_.clear();
    for (const char c : value) {
      if (c != ',' && columns_.size() < kMaxColumns) columns_.push_back(c);
    }
  }
}

PcanTrace::Line PcanTrace::parse(std::string_view text) {
  Line line;
  if (text.starts_with(";$")) on_keyword(text);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos || text[0] == ';') {
    line.kind = Line::Kind::kComment;
    return line;
  }
  if (columns_.find('O') == std::string::npos || columns_.find('T') == std::string::npos ||
      columns_.find('I') == std::string::npos || columns_.find_first_of("Ll") == std::string::npos ||
      columns_.back() != 'D') {
    return line;  // without these nothing can be parsed
  }
  Type type = Type::kOther;
  std::string_view rest = text;
  for (const char column : columns_) {
    if (column == 'D') break;
    const std::string_view word = next_word(rest);
    if (word.empty()) return line;
    if (column == 'O') {
      const auto offset = parse_number(word);
      if (!offset || *offset < 0 || *offset > kMaxOffset) return line;
      line.utime = start_ + std::llround(*offset * 1e3);
    } else if (column == 'T') {
      type = type_of(word, old_);
      if (type == Type::kOther) {  // its columns differ
        line.kind = Line::Kind::kOther;
        return line;
      }
    } else if (column == 'B') {
      line.bus = word;
    } else if (column == 'I') {
      if (!parse_id(word, line.frame)) return line;
    } else if (column == 'L' || column == 'l') {
      if (word.size() != 1 || word[0] < '0' || word[0] > '8') return line;
      line.frame.size = static_cast<std::uint8_t>(word[0] - '0');
    }
  }
  line.frame.remote = type == Type::kRemote || (old_ && rest.find("RTR") != std::string_view::npos);
  if (!line.frame.remote && !parse_data(rest, line.frame)) return line;
  line.kind = Line::Kind::kFrame;
  return line;
}

}  // namespace curbstone::encoder::traces
