#pragma once

#include <string_view>

namespace curbstone::command {

/// What carries out a subcommand. argv[0] is its name. Returns the exit status.
using Run = int (*)(int argc, char** argv);

/// Runs it and reports an exception in one line on stderr; the exit status is then 1, or 2 where the user's
/// configuration is wrong.
int run_subcommand(std::string_view name, Run run, int argc, char** argv);

}  // namespace curbstone::command
