#include "tools/command/run_subcommand.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "common/config/config.hpp"
#include "common/config/standard_streams.hpp"
#include "common/config/version.hpp"

namespace curbstone::command {

int run_subcommand(std::string_view name, Run run, int argc, char** argv) {
  guard_standard_streams();
  if (argc > 1 && std::string_view(argv[1]) == "--version") {  // those with commands of their own have no CommandLine
    fmt::print("{}\n", version());
    return 0;
  }
  try {
    return run(argc, argv);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "curbstone {}: {}\n", name, error.what());
    return 2;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return 1;  // why is said at the end of the process
    fmt::print(stderr, "curbstone {}: {}\n", name, error.what());
    return 1;
  }
}

}  // namespace curbstone::command
