#include "tools/command/run_subcommand.hpp"
#include "tools/play/play.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("play", curbstone::play::run_play, argc, argv);
}
