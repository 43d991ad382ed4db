#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::procman::config {

/// The parts of an exec string: what to put into the environment, and what to execute.
struct ExecLine {
  std::vector<std::pair<std::string, std::string>> environment;
  std::vector<std::string> argv;
  std::vector<std::string> unknown_variables;  ///< $NAMEs that stayed as written, because they are not set
  std::string error;                           ///< in words; empty when argv can be executed
};

/// Splits an exec string as procman does, in the manner of a shell but without one. Blanks separate words. Single and
/// double quotes group, and are removed. A backslash takes the next character literally, in either kind of quotes too.
/// Leading words `NAME=VALUE` are assignments. In the words after them $NAME and ${NAME} are replaced by `lookup`;
/// quotes do not prevent it. Assignments are neither expanded nor used by it. Unknown names stay as written.
[[nodiscard]] ExecLine parse_exec_line(const std::string& exec,
                                       const std::function<std::optional<std::string>(const std::string&)>& lookup);

/// A `lookup` in this process's environment.
[[nodiscard]] std::optional<std::string> from_environment(const std::string& name);

}  // namespace curbstone::procman::config
