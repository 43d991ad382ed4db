#pragma once

#include <optional>
#include <string>

namespace curbstone::test {

/// The folder in which node finds Foxglove's packages; installed there if it can be. Nothing: there is no node, no npm,
/// or no registry.
[[nodiscard]] std::optional<std::string> foxglove_packages();

/// What a program says; what it says on stderr fails the test.
[[nodiscard]] std::string output_of(const std::string& command);

}  // namespace curbstone::test
