#include "tools/command/run_subcommand.hpp"
#include "tools/spy/spy.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("spy", curbstone::spy::run_spy, argc, argv);
}
