#include "tools/log_tool/log_tool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "tools/log_tool/commands.hpp"

namespace curbstone::log_tool {

namespace {

struct LogCommand {
  std::string_view name;
  std::string_view summary;
  int (*run)(int argc, char** argv);
};

constexpr std::array kLogCommands = {
    LogCommand{"info", "what is in it: channels, types, rates, times, gaps, damage, configuration", run_info},
    LogCommand{"cut", "a part of it by time", run_cut},
    LogCommand{"join", "several, or a session, as one", run_join},
    LogCommand{"repair", "what can be read of a damaged one", run_repair},
    LogCommand{"filter", "some of its channels", run_filter},
    LogCommand{"csv", "the fields of a channel as a table", run_csv},
    LogCommand{"pcd", "its LiDAR scans as point clouds", run_pcd},
};

int log_usage(std::FILE* out) {
  fmt::print(out, "usage: curbstone log COMMAND [OPTIONS]   (curbstone log COMMAND --help says more)\n\n");
  for (const LogCommand& command : kLogCommands) fmt::print(out, "  {:<8} {}\n", command.name, command.summary);
  return out == stdout ? 0 : 2;
}

}  // namespace

int run_log(int argc, char** argv) {
  if (argc < 2) return log_usage(stderr);
  const std::string_view name = argv[1];
  if (name == "--help" || name == "-h") return log_usage(stdout);
  const auto* command = std::find_if(kLogCommands.begin(), kLogCommands.end(),
                                     [&](const LogCommand& candidate) { return candidate.name == name; });
  if (command != kLogCommands.end()) return command->run(argc - 1, argv + 1);
  fmt::print(stderr, "curbstone log: no command '{}'\n", name);
  return log_usage(stderr);
}

}  // namespace curbstone::log_tool
