#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/terminal/terminal_table.hpp"

namespace curbstone {

/// The output of a live table: a terminal, whose content each picture replaces, or a file or pipe, to which the
/// pictures are appended as plain text. $NO_COLOR (no-color.org) and TERM=dumb turn colours off.
class Screen {
 public:
  /// `fd` remains owned by the caller.
  explicit Screen(int fd);

  [[nodiscard]] bool is_terminal() const { return is_terminal_; }
  /// The style for the terminal's present size: it may be resized.
  [[nodiscard]] TextStyle style() const;
  /// Returns false when the reader is gone. Throws std::runtime_error if the lines cannot be written, as on a full
  /// disk.
  bool show(const std::vector<std::string>& lines) const;

 private:
  int fd_;
  bool is_terminal_;
  bool colours_;
};

/// The bytes that make these lines the terminal's content (ECMA-48): from its upper left corner, the previous content
/// is erased, at most `height` lines (0: all). Nothing scrolls or flickers.
[[nodiscard]] std::string screen_bytes(const std::vector<std::string>& lines, std::size_t height);

}  // namespace curbstone
