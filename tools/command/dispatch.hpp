#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "tools/command/run_subcommand.hpp"

namespace curbstone::command {

struct Subcommand {
  std::string_view name;
  std::string_view summary;
  Run run = nullptr;  ///< none: it is the program curbstone-NAME
};

/// `curbstone SUBCOMMAND ...`, and --help, which lists them all. `folder` has the subcommands that are programs of
/// their own. Returns the exit status: 2 for wrong usage, else the subcommand's.
int dispatch(std::span<const Subcommand> subcommands, const std::filesystem::path& folder, int argc, char** argv);

}  // namespace curbstone::command
