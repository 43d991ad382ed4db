#include "tools/command/dispatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "tools/command/program_beside.hpp"

namespace curbstone::command {

namespace {

int usage(std::span<const Subcommand> subcommands, std::FILE* out) {
  fmt::print(out, "usage: curbstone SUBCOMMAND [OPTIONS]   (curbstone SUBCOMMAND --help says more)\n\n");
  for (const Subcommand& subcommand : subcommands)
    fmt::print(out, "  {:<10} {}\n", subcommand.name, subcommand.summary);
  return out == stdout ? 0 : 2;
}

}  // namespace

int dispatch(std::span<const Subcommand> subcommands, const std::filesystem::path& folder, int argc, char** argv) {
  if (argc < 2) return usage(subcommands, stderr);
  const std::string_view name = argv[1];
  if (name == "--help" || name == "-h" || name == "help") return usage(subcommands, stdout);
  const auto found = std::find_if(subcommands.begin(), subcommands.end(),
                                  [name](const Subcommand& subcommand) { return subcommand.name == name; });
  if (found == subcommands.end()) {
    fmt::print(stderr, "curbstone: no subcommand '{}'\n", name);
    return usage(subcommands, stderr);
  }
  if (found->run == nullptr) return exec_program(name, folder, argv + 1);
  return run_subcommand(name, found->run, argc - 1, argv + 1);
}

}  // namespace curbstone::command
