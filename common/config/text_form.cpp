#include "common/config/text_form.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/config/config.hpp"

namespace curbstone {

namespace {

/// Other encodings begin with a byte order mark, or with a character that has zero bytes.
bool is_utf8(std::string_view text) {
  return !text.starts_with("\xFF\xFE") && !text.starts_with("\xFE\xFF") &&
         !text.starts_with(std::string_view("\0", 1)) && !(text.size() > 1 && text[1] == '\0');
}

}  // namespace

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
