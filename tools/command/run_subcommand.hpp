#pragma once

#include <string_view>

namespace curbstone::command {

/// A subcommand's function. argv[0] is its name. Returns the exit status.
using Run = int (*)(int argc, char** argv);

/// Runs a subcommand, or prints the version for --version. Reports an exception in one line on stderr; the exit status
/// is then 1, or 2 for an invalid configuration.
int run_subcommand(std::string_view name, Run run, int argc, char** argv);

}  // namespace curbstone::command
