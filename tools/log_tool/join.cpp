#include "tools/log_tool/commands.hpp"
#include "tools/log_tool/log_copy.hpp"

namespace curbstone::log_tool {

int run_join(int argc, char** argv) {
  CopyOptions options;
  CommandLine line("Several logs, or the files of a session, as one: in the order of time", "curbstone log join");
  options.declare(line);
  if (const auto status = line.read(argc, argv)) return *status;
  return copy_log(options, "join", [](const LogEvent&) { return true; }).damaged() ? 1 : 0;
}

}  // namespace curbstone::log_tool
