#include "tools/log_tool/commands.hpp"
#include "tools/log_tool/log_copy.hpp"

namespace curbstone::log_tool {

int run_repair(int argc, char** argv) {
  CopyOptions options;
  CommandLine line("What can be read of a damaged log, with its records numbered anew", "curbstone log repair");
  options.declare(line);
  if (const auto status = line.read(argc, argv)) return *status;
  (void)copy_log(options, "repair", [](const LogEvent&) { return true; });
  return 0;
}

}  // namespace curbstone::log_tool
