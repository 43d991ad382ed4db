#pragma once

#include <charconv>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace curbstone::detect {

/// Removes and returns the first word of a line; empty at its end.
inline std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t begin = line.find_first_not_of(kBlanks);
  line.remove_prefix(begin == std::string_view::npos ? line.size() : begin);
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

/// The whole word as a number; also nan and inf, as printf writes them. Empty for "1,5" and "1.5m".
template <class Number = double>
std::optional<Number> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool is_tiny = error == std::errc::result_out_of_range && word.find_first_of("eE") != std::string_view::npos &&
                       word.find("-", word.find_first_of("eE")) != std::string_view::npos;  // 1e-400
  if (std::is_floating_point_v<Number> && is_tiny) return Number{};
  if (error != std::errc{} || end != word.data() + word.size()) return {};
  return number;
}

/// The lines of a text, with their numbers from 1. A byte order mark is skipped.
class TextLines {
 public:
  explicit TextLines(std::istream& in) : in_(in) {}

  /// The next line; false at the end. A line of more than kMaxLine characters ends the text: it is none.
  bool next() {
    constexpr std::size_t kMaxLine = 1 << 16;
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    line_.clear();
    ++number_;
    int c = in_.get();
    if (c == EOF) return false;
    for (; c != EOF && c != '\n'; c = in_.get()) {
      if (line_.size() == kMaxLine) return false;
      line_.push_back(static_cast<char>(c));
    }
    if (number_ == 1 && line_.starts_with(kByteOrderMark)) line_.erase(0, kByteOrderMark.size());
    return true;
  }
  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] int number() const { return number_; }

 private:
  std::istream& in_;
  std::string line_;
  int number_ = 0;
};

}  // namespace curbstone::detect
