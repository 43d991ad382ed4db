#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "tools/command/run_subcommand.hpp"

namespace curbstone::command {

struct Subcommand {
  std::string_view name;
  std::string_view summary;
  Run run = nullptr;  ///< null: it is the program curbstone-NAME
};

/// Runs `curbstone SUBCOMMAND ...`, and --help, which lists all subcommands. `folder` holds the subcommands that are
/// separate programs. Returns the exit status: 2 for wrong usage, else that of the subcommand.
int dispatch(std::span<const Subcommand> subcommands, const std::filesystem::path& folder, int argc, char** argv);

}  // namespace curbstone::command
