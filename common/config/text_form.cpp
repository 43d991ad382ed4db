#include "common/config/text_form.hpp"

#include <fmt/format.h>
#include <yaml-cpp/exceptions.h>

#include <algorithm>

#include "common/config/config.hpp"

namespace curbstone {

namespace {

/// Other encodings begin with a byte order mark, or with a character that has zero bytes.
bool is_utf8(std::string_view text) {
  return !text.starts_with("\xFF\xFE") && !text.starts_with("\xFE\xFF") &&
         !text.starts_with(std::string_view("\0", 1)) && !(text.size() > 1 && text[1] == '\0');
}

/// `line` counts from 0; negative if the parser does not know it.
bool is_indented_by_tab(std::string_view text, int line) {
  for (; line > 0; --line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return false;
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find_first_not_of(" \t")).find('\t') != std::string_view::npos;
}

}  // namespace

std::string syntax_advice(std::string_view text, int line, const std::string& message) {
  if (is_indented_by_tab(text, line)) return ": indent by spaces, not by a tab";
  if (message != YAML::ErrorMsg::MAP_VALUE) return "";
  return ": is it indented as the lines around it, and has the line before its colon?";
}

void refuse_odd_text(std::string_view text, const std::string& name) {
  if (text.find_first_not_of('\0') == std::string_view::npos && !text.empty())
    throw ConfigError(fmt::format("{}:1: nothing but zero bytes, as after a power cut: write the file anew", name));
  if (!is_utf8(text)) return;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto line = [&] { return std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n') + 1; };
    if (text[i] == '\0')
      throw ConfigError(fmt::format("{}:{}: a zero byte: the file is damaged: write it anew", name, line()));
    if (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'))
      throw ConfigError(
          fmt::format("{}:{}: a line ends with a carriage return alone: tr '\\r' '\\n' mends it", name, line()));
  }
}

}  // namespace curbstone
