#include "tools/detect/detect.hpp"

#include "tools/command/run_subcommand.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("detect", curbstone::detect::run_detect, argc, argv);
}
