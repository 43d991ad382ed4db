#include "tools/command/run_subcommand.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "common/config/config.hpp"

namespace curbstone::command {

int run_subcommand(std::string_view name, Run run, int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "curbstone {}: {}\n", name, error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "curbstone {}: {}\n", name, error.what());
    return 1;
  }
}

}  // namespace curbstone::command
