#include "tools/bench/programs/background_program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

namespace curbstone::bench::programs {

int shell_status(int wait_status) {
  return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
}

namespace {

/// Copies them out of the way first: one may have the number of another.
void pass(const std::vector<int>& fds) {
  const int first = STDERR_FILENO + 1;
  const int clear = first + static_cast<int>(fds.size());
  std::vector<int> copies;
  for (const int fd : fds) copies.push_back(fcntl(fd, F_DUPFD_CLOEXEC, clear));
  for (std::size_t i = 0; i < copies.size(); ++i) dup2(copies[i], first + static_cast<int>(i));
}

}  // namespace

BackgroundProgram::BackgroundProgram(const std::string& line, std::string output_file, const std::vector<int>& passed)
    : output_file_(std::move(output_file)) {
  const std::string replaced = "exec " + line;
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ != 0) return;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);  // the parent died before the prctl()
  const int output = open(output_file_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  if (output >= 0) {
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
  }
  pass(passed);
  execl("/bin/sh", "sh", "-c", replaced.c_str(), nullptr);
  _exit(127);
}

BackgroundProgram::~BackgroundProgram() {
  if (!running()) return;
  send_signal(SIGTERM);
  if (wait(15) >= 0) return;
  send_signal(SIGKILL);
  wait(5);
}

void BackgroundProgram::send_signal(int signal) const {
  if (!reaped_) kill(pid_, signal);
}

bool BackgroundProgram::running() {
  return wait(0) < 0;
}

int BackgroundProgram::wait(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!reaped_) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      reaped_ = true;
      status_ = shell_status(status);
    } else if (std::chrono::steady_clock::now() >= end) {
      return -1;
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  return status_;
}

std::string BackgroundProgram::output() const {
  std::ifstream stream(output_file_, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace curbstone::bench::programs
