#include "tools/command/run_subcommand.hpp"
#include "tools/doctor/doctor.hpp"

int main(int argc, char** argv) {
  return curbstone::command::run_subcommand("doctor", curbstone::doctor::run_doctor, argc, argv);
}
