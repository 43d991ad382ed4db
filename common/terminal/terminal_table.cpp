#include "common/terminal/terminal_table.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace curbstone {

namespace {

std::string_view sgr(Colour colour) {
  switch (colour) {
    case Colour::kBold:
      return "\x1b[1m";
    case Colour::kDim:
      return "\x1b[2m";
    case Colour::kGood:
      return "\x1b[32m";
    case Colour::kWarning:
      return "\x1b[33m";
    case Colour::kBad:
      return "\x1b[31m";
    default:
      return "";
  }
}

bool continues(char c) {
  return (static_cast<std::uint8_t>(c) & 0xC0U) == 0x80U;
}

/// The number of UTF-8 characters.
std::size_t length_of(std::string_view text) {
  return text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), continues));
}

/// The first `count` characters.
std::string_view beginning(std::string_view text, std::size_t count) {
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    if (!continues(text[at]) && count-- == 0) break;
  }
  return text.substr(0, at);
}

/// The length in bytes of the UTF-8 character that begins here; 0 if there is none.
std::size_t character_at(std::string_view text) {
  const auto first = static_cast<std::uint8_t>(text.front());
  const std::size_t size = first < 0x80 ? 1 : first >= 0xC2 && first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if ((first >= 0x80 && first < 0xC2) || first > 0xF4 || text.size() < size) return 0;
  return std::all_of(text.begin() + 1, text.begin() + static_cast<std::ptrdiff_t>(size), continues) ? size : 0;
}

/// Control characters: C0, DEL, and C1 (U+0080 to U+009F), which some terminals obey too.
bool steers(std::string_view character) {
  const auto first = static_cast<std::uint8_t>(character.front());
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  return first == 0xC2 && static_cast<std::uint8_t>(character[1]) < 0xA0;
}

/// A line assembled from pieces, cut at the style's width.
class LineWriter {
 public:
  explicit LineWriter(const TextStyle& style) : style_(style) {}

  void add(std::string_view text, Colour colour) {
    if (style_.width > 0) text = beginning(text, style_.width - std::min(style_.width, used_));
    if (text.empty()) return;
    const std::string_view begin = style_.colours ? sgr(colour) : "";
    line_.append(std::exchange(gap_, 0), ' ').append(begin).append(text).append(begin.empty() ? "" : "\x1b[0m");
    used_ += length_of(text);
  }
  /// Adds spaces, which are written only if text follows.
  void skip(std::size_t count) {
    gap_ += count;
    used_ += count;
  }
  [[nodiscard]] std::string take() { return std::move(line_); }

 private:
  TextStyle style_;
  std::string line_;
  std::size_t used_ = 0;
  std::size_t gap_ = 0;
};

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t size = character_at(text);
    if (size == 0 || steers(text.substr(0, size)))
      shown += '?';
    else
      shown += text.substr(0, size);
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return shown;
}

std::string styled_line(std::string_view text, Colour colour, const TextStyle& style) {
  LineWriter writer(style);
  writer.add(printable(text), colour);
  return writer.take();
}

void TerminalTable::add_row(std::vector<Cell> cells) {
  cells.resize(columns_.size());
  for (Cell& cell : cells) cell.text = printable(cell.text);
  rows_.push_back(std::move(cells));
}

std::vector<std::string> TerminalTable::lines(const TextStyle& style) const {
  std::vector<std::size_t> widths;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    widths.push_back(std::max(columns_[k].least, length_of(columns_[k].title)));
    for (const auto& row : rows_) widths[k] = std::max(widths[k], length_of(row[k].text));
  }
  std::vector<std::string> lines;
  const auto write = [&](const auto& cell_of) {
    LineWriter writer(style);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const Cell& cell = cell_of(k);
      const std::size_t padding = widths[k] - length_of(cell.text);
      const bool right = columns_[k].align == Align::kRight;
      writer.skip((k > 0 ? 2 : 0) + (right ? padding : 0));
      writer.add(cell.text, cell.colour);
      writer.skip(right ? 0 : padding);
    }
    lines.push_back(writer.take());
  };
  write([&](std::size_t k) { return Cell{columns_[k].title, Colour::kBold}; });
  for (const auto& row : rows_) write([&](std::size_t k) { return row[k]; });
  return lines;
}

}  // namespace curbstone
