#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace curbstone::bench::programs {

/// The status of an ended process in the shell's convention: its exit status, or 128 + n if signal n ended it.
[[nodiscard]] int shell_status(int wait_status);

/// A program that runs in the background. It is ended with this object, and gets SIGTERM if the thread that started it
/// dies earlier by any signal.
class BackgroundProgram {
 public:
  /// `line`: a command for sh, which execs the program. Output is appended to `output_file`. The program has `passed`
  /// as its descriptors 3, 4 and so on.
  BackgroundProgram(const std::string& line, std::string output_file, const std::vector<int>& passed = {});
  ~BackgroundProgram();
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  void send_signal(int signal) const;
  [[nodiscard]] bool running();
  /// Waits at most `seconds` for the end. Returns the shell status, -1 if it still runs.
  int wait(double seconds);
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] std::string output() const;

 private:
  pid_t pid_ = 0;
  bool reaped_ = false;
  int status_ = -1;
  std::string output_file_;
};

}  // namespace curbstone::bench::programs
