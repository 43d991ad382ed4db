#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

/// @file
/// JSON as text. nlohmann's parser and writer are compiled once, here, because each adds a second to the compile time
/// of every file that uses it. Pure; any thread.

namespace curbstone {

/// The text of `value`: on one line, or with `indent` spaces a level. Bytes that are no UTF-8 are replaced by U+FFFD.
[[nodiscard]] std::string json_text(const nlohmann::json& value, int indent = -1);

/// Throws nlohmann::json::parse_error if `text` is not JSON.
[[nodiscard]] nlohmann::json parse_json(std::string_view text);

/// The JSON in a file. Throws nlohmann::json::parse_error if there is none, or no such file.
[[nodiscard]] nlohmann::json read_json(const std::string& file);

/// For text from outside: is_discarded() if it is not JSON.
[[nodiscard]] nlohmann::json try_parse_json(std::string_view text);

}  // namespace curbstone
