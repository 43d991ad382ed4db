#pragma once

#include <sys/types.h>

#include <string>

namespace curbstone::system_test {

struct ProgramResult {
  int exit_status = -1;  ///< as a shell has it: 128 + n when killed by signal n, 124 when it took too long
  std::string out;
  std::string err;
};
/// Runs "curbstone-ekf --config ..." (as a shell does; our programs are found) to its end, at most `seconds`.
ProgramResult run_program(const std::string& command, double seconds = 20);

/// A program that runs while the test does other things; killed with its owner.
class BackgroundProgram {
 public:
  /// Output goes to `output_file`.
  BackgroundProgram(const std::string& command, std::string output_file);
  ~BackgroundProgram();
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  void send_signal(int signal) const;
  [[nodiscard]] bool running();
  /// Waits at most `seconds` for the end; the exit status as above, -1 when it still runs.
  int wait(double seconds);
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] std::string output() const;

 private:
  pid_t pid_ = 0;
  bool reaped_ = false;
  int status_ = -1;
  std::string output_file_;
};

[[nodiscard]] std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& text);

}  // namespace curbstone::system_test
