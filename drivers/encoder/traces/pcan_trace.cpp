#include "drivers/encoder/traces/pcan_trace.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "drivers/encoder/can/hex.hpp"

namespace curbstone::encoder::traces {

namespace {

constexpr double kEpochDay = 25569;  // 1970-01-01, in days since 1899-12-30
constexpr double kMaxDays = 100'000;
constexpr double kMaxOffset = 1e12;  // ms: 30 years
constexpr std::size_t kMaxColumns = 16;
constexpr double kMaxCode = 15;      // of a length
constexpr double kMaxLength = 1785;  // bytes, J1939
constexpr std::string_view kStatusId = "FFFFFFFF";

/// The columns of a version, where its file does not name them.
struct Format {
  std::string_view version;
  const char* columns;
};
constexpr Format kFormats[] = {{"1.0", "NOILD"},   {"1.1", "NOTILD"},    {"1.2", "NOBTILD"},       {"1.3", "NOBTIRLD"},
                               {"2.0", "NOTIdlD"}, {"2.1", "NOTBIdRLD"}, {"3.0", "NOTBIdRVSArsLD"}};

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// "72.1", or "72,1": PCAN-View writes the decimal sign of its host's language.
std::optional<double> parse_decimal(std::string_view word) {
  std::string text(word.substr(0, 32));
  if (std::ranges::count(text, ',') == 1 && text.find('.') == std::string::npos) text[text.find(',')] = '.';
  return parse_number(text);
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

}  // namespace

void PcanTrace::on_keyword(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return;
  std::string_view before = line.substr(0, equals);
  const std::string_view key = next_word(before);
  std::string_view rest = line.substr(equals + 1);
  std::string_view value = next_word(rest);
  if (value.ends_with(';')) value.remove_suffix(1);  // PCAN-Explorer 5
  if (key == ";$FILEVERSION") {
    const auto* format = std::ranges::find(kFormats, value, &Format::version);
    const bool known = format != std::end(kFormats);
    foreign_version_ = known ? "" : std::string(value.substr(0, 20));
    if (known) columns_ = format->columns;
    old_ = value.starts_with("1.");
  } else if (key == ";$STARTTIME") {
    const auto days = parse_decimal(value);
    if (days && *days >= kEpochDay && *days <= kMaxDays) start_ = std::llround((*days - kEpochDay) * 86400e6);
  } else if (key == ";$COLUMNS") {
    columns_.clear();
    for (const char c : value) {
      if (c != ',' && columns_.size() < kMaxColumns) columns_.push_back(c);
    }
  }
}

PcanTrace::Type PcanTrace::type_of(std::string_view word) const {
  if (old_) return word == "Rx" || word == "Tx" ? Type::kData : Type::kOther;
  return word == "DT" ? Type::kData : word == "RR" ? Type::kRemote : Type::kOther;
}

/// Without these columns nothing can be parsed.
bool PcanTrace::has_needed_columns() const {
  const auto has = [this](const char* any) { return columns_.find_first_of(any) != std::string::npos; };
  return has("O") && has("I") && has("Ll") && columns_.back() == 'D' && (old_ || has("T"));
}

/// The length of the data. A length code above 8 of a classical frame is 8 bytes; a length above it is a J1939 message
/// of several frames.
std::optional<PcanTrace::Line::Kind> PcanTrace::read_length(char column, std::string_view word, Columns& read) {
  const auto length = parse_number(word);
  if (!length || *length < 0 || *length > kMaxLength || *length != std::floor(*length)) return Line::Kind::kRefused;
  if (*length > 8 && (column == 'l' || read.addressed || *length > kMaxCode)) return Line::Kind::kOther;
  read.line.frame.size = static_cast<std::uint8_t>(std::min(*length, 8.0));
  return {};
}

/// Reads a column before the data. Returns the line's kind if that shows that it is no frame.
std::optional<PcanTrace::Line::Kind> PcanTrace::read_column(char column, std::string_view word, Columns& read) const {
  Line& line = read.line;
  if (column == 'O') {
    const auto offset = parse_decimal(word);
    if (!offset || *offset < 0 || *offset > kMaxOffset) return Line::Kind::kRefused;
    line.utime = start_ + std::llround(*offset * 1e3);
  } else if (column == 'T') {
    read.type = type_of(word);
    if (read.type == Type::kOther) return Line::Kind::kOther;  // its columns differ
  } else if (column == 'B') {
    line.bus = word;
  } else if (column == 'I') {
    if (old_ && word == kStatusId) return Line::Kind::kOther;
    if (!parse_id(word, line.frame)) return Line::Kind::kRefused;
  } else if (column == 'R') {
    read.addressed = word != "-";
  } else if (column == 'L' || column == 'l') {
    return read_length(column, word, read);
  }
  return {};
}

/// Reads what follows the other columns.
PcanTrace::Line::Kind PcanTrace::read_data(std::string_view text, Columns& read) const {
  std::string_view after = text;
  const std::string_view first = next_word(after);
  if (old_ && first == "ERROR") return Line::Kind::kOther;
  read.line.frame.remote = read.type == Type::kRemote || (old_ && first == "RTR");
  return read.line.frame.remote || parse_data(text, read.line.frame) ? Line::Kind::kFrame : Line::Kind::kRefused;
}

PcanTrace::Line PcanTrace::parse(std::string_view text) {
  Columns read;
  const auto of_kind = [&read](Line::Kind kind) {
    read.line.kind = kind;
    return read.line;
  };
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.starts_with(";$")) on_keyword(text);
  if (text.empty() || text[0] == ';') return of_kind(Line::Kind::kComment);
  if (!has_needed_columns()) return of_kind(Line::Kind::kRefused);
  for (const char column : columns_) {
    if (column == 'D') break;
    const std::string_view word = next_word(text);
    if (word.empty()) return of_kind(Line::Kind::kRefused);
    if (const auto kind = read_column(column, word, read)) return of_kind(*kind);
  }
  return of_kind(read_data(text, read));
}

}  // namespace curbstone::encoder::traces
