#include "tools/command/run_subcommand.hpp"
#include "tools/view/view.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("view", curbstone::view::run_view, argc, argv);
}
