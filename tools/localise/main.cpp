#include "tools/localise/localise.hpp"

#include "tools/command/run_subcommand.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("localise", curbstone::localise::run_localise, argc, argv);
}
