#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/terminal/terminal_table.hpp"

namespace curbstone {

/// What a live table is shown on: a terminal, whose content each picture replaces, or a file or pipe, to which the
/// pictures are appended as plain text. $NO_COLOR (no-color.org) and TERM=dumb turn colours off.
class Screen {
 public:
  /// `fd` stays the caller's.
  explicit Screen(int fd);

  [[nodiscard]] bool is_terminal() const { return is_terminal_; }
  /// Of the terminal as it is now: it may be resized.
  [[nodiscard]] TextStyle style() const;
  /// Returns false when nobody reads any more.
  bool show(const std::vector<std::string>& lines) const;

 private:
  int fd_;
  bool is_terminal_;
  bool colours_;
};

/// The bytes that make these lines the terminal's content (ECMA-48): from its upper left corner, what was there before
/// is erased, at most `height` lines (0: all). Nothing scrolls, and nothing flickers.
[[nodiscard]] std::string screen_bytes(const std::vector<std::string>& lines, std::size_t height);

}  // namespace curbstone
