#pragma once

#include <string>
#include <string_view>

namespace curbstone::procman::output {

/// A line of a command with the command's id before it, unless the service has put it there already.
[[nodiscard]] inline std::string named_line(const std::string& id, std::string_view line) {
  std::string named = id + ": ";
  if (line.starts_with(named)) return std::string(line);
  named += line;
  return named;
}

}  // namespace curbstone::procman::output
