#pragma once

#include <optional>
#include <string>
#include <vector>

namespace curbstone::doctor::facts {

/// The standard output of a program; empty if it cannot be started or fails. No shell is involved.
[[nodiscard]] std::optional<std::string> program_output(const std::vector<std::string>& words);

}  // namespace curbstone::doctor::facts
