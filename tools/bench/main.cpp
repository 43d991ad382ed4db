#include "tools/bench/bench.hpp"

#include "tools/command/run_subcommand.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("bench", curbstone::bench::run_bench, argc, argv);
}
