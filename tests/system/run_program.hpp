#pragma once

#include <string>

#include "tools/bench/programs/background_program.hpp"

namespace curbstone::system_test {

struct ProgramResult {
  int exit_status = -1;  ///< as a shell has it: 128 + n when killed by signal n, 124 when it took too long
  std::string out;
  std::string err;
};
/// Runs "curbstone-ekf --config ..." (as a shell does; our programs are found) to its end, at most `seconds`.
ProgramResult run_program(const std::string& command, double seconds = 20);

/// One of our programs that runs while the test does other things; killed with its owner.
class BackgroundProgram : public bench::programs::BackgroundProgram {
 public:
  BackgroundProgram(const std::string& command, const std::string& output_file);
};

[[nodiscard]] std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& text);

}  // namespace curbstone::system_test
