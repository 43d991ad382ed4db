#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::procman::config {

/// The parts of an exec string: assignments for the environment, and the words to execute.
struct ExecLine {
  std::vector<std::pair<std::string, std::string>> environment;
  std::vector<std::string> argv;
  std::vector<std::string> unknown_variables;  ///< $NAMEs that are kept as written because they are not set
  std::string error;                           ///< in words; empty if argv can be executed
};

/// Splits an exec string like procman: like a shell, but without one. Blanks separate words. Single and double quotes
/// group, and are removed. A backslash takes the next character literally, in both kinds of quotes too. Leading words
/// `NAME=VALUE` are assignments. In the words after them $NAME and ${NAME} are replaced by `lookup`, in quotes too.
/// Assignments are not expanded, and `lookup` does not see them. Unknown names are kept as written.
[[nodiscard]] ExecLine parse_exec_line(const std::string& exec,
                                       const std::function<std::optional<std::string>(const std::string&)>& lookup);

/// A `lookup` that uses this process's environment.
[[nodiscard]] std::optional<std::string> from_environment(const std::string& name);

}  // namespace curbstone::procman::config
