#include "tools/command/run_subcommand.hpp"
#include "tools/log_tool/log_tool.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("log", curbstone::log_tool::run_log, argc, argv);
}
