#pragma once

#include <string>
#include <string_view>

namespace curbstone::procman::output {

/// Splits a stream of bytes into lines, without their "\n" or "\r\n". A line longer than kMaxLine is cut there.
class LineSplitter {
 public:
  static constexpr std::size_t kMaxLine = 4096;

  template <class OnLine>
  void feed(std::string_view text, OnLine on_line) {
    for (const char c : text) {
      if (c == '\n') {
        flush(on_line, true);
      } else {
        if (line_.size() >= kMaxLine) flush(on_line, true);
        line_ += c;
      }
    }
  }
  /// Passes on the unfinished line at the end, if there is one.
  template <class OnLine>
  void flush(OnLine on_line, bool even_empty = false) {
    if (line_.ends_with('\r')) line_.pop_back();
    if (even_empty || !line_.empty()) on_line(std::string_view(line_));
    line_.clear();
  }

 private:
  std::string line_;
};

}  // namespace curbstone::procman::output
