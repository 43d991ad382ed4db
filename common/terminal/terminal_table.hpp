#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace curbstone {

enum class Colour { kPlain, kBold, kDim, kGood, kWarning, kBad };

/// The style of the lines: for a file or a pipe (the default), or for a terminal.
struct TextStyle {
  bool colours = false;   ///< by SGR sequences (ECMA-48)
  std::size_t width = 0;  ///< columns; longer lines are cut; 0: no limit
};

/// Text of foreign origin (a channel's name, a fault) made safe to show: terminal control characters and invalid UTF-8
/// become '?'.
[[nodiscard]] std::string printable(std::string_view text);

/// One line in a colour, cut and coloured as the style says. `text` is made printable.
[[nodiscard]] std::string styled_line(std::string_view text, Colour colour, const TextStyle& style);

/// A table as lines of text: columns as wide as their widest cell, two spaces between them. Pure.
///
///     TerminalTable table({{"channel"}, {"Hz", Align::kRight}});
///     table.add_row({{"IMU"}, {"99.8", Colour::kGood}});
///     for (const std::string& line : table.lines(style)) ...
class TerminalTable {
 public:
  enum class Align { kLeft, kRight };
  struct Column {
    std::string title;
    Align align = Align::kLeft;
    std::size_t least = 0;  ///< characters, so that a live table does not jump when its values grow longer
  };
  struct Cell {
    std::string text;
    Colour colour = Colour::kPlain;
  };

  explicit TerminalTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
  /// Missing cells are empty; cells beyond the last column are ignored.
  void add_row(std::vector<Cell> cells);
  /// The titles and one line for each row, without line ends. No line ends with spaces.
  [[nodiscard]] std::vector<std::string> lines(const TextStyle& style = {}) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace curbstone
