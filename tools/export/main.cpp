#include "tools/export/export.hpp"

#include "tools/command/run_subcommand.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("export", curbstone::map_export::run_export, argc, argv);
}
