#pragma once

#include <sys/types.h>

#include <string>

namespace curbstone::bench::faults {

/// How a process ended, as a shell has it: its exit status, or 128 + n when signal n ended it.
[[nodiscard]] int shell_status(int wait_status);

/// A program that runs while its owner does other things; it is ended with its owner, and gets SIGTERM where the thread
/// that started it dies before that, by whatever signal.
class BackgroundProgram {
 public:
  /// `line` is for sh, which replaces itself by the program. Output goes to the end of `output_file`.
  BackgroundProgram(const std::string& line, std::string output_file);
  ~BackgroundProgram();
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  void send_signal(int signal) const;
  [[nodiscard]] bool running();
  /// Waits at most `seconds` for the end; the shell status, -1 when it still runs.
  int wait(double seconds);
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] std::string output() const;

 private:
  pid_t pid_ = 0;
  bool reaped_ = false;
  int status_ = -1;
  std::string output_file_;
};

}  // namespace curbstone::bench::faults
