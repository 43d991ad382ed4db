#include "tools/calibrate/calibrate.hpp"

#include "tools/command/run_subcommand.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("calibrate", curbstone::calibrate::run_calibrate, argc, argv);
}
