#include "common/config/number_advice.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace curbstone {

namespace {

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

bool is_digit_at(const std::string& text, std::size_t at) {
  return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}

}  // namespace

std::string number_advice(const std::string& text) {
  std::string with_point = text;
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  if (with_point != text && is_number(with_point)) return ": write " + with_point;
  if (const auto comment = text.find('#'); comment != std::string::npos && is_number(text.substr(0, comment)))
    return ": a comment needs a space before its #";
  char* end = nullptr;
  std::strtod(with_point.c_str(), &end);
  return end != with_point.c_str() ? ": only a number, without a unit" : "";
}

std::optional<std::string> without_leading_zeros(const std::string& text) {
  const std::size_t first = text.find_first_not_of("+-");
  if (first == std::string::npos || text[first] != '0' || !is_digit_at(text, first + 1)) return std::nullopt;
  const std::size_t digit = std::min(text.find_first_not_of('0', first), text.size() - 1);
  return text.substr(0, first) + text.substr(digit);
}

}  // namespace curbstone
