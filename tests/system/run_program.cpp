#include "tests/system/run_program.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {

namespace {

int shell_status(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

const std::string kPath = "PATH=" CURBSTONE_BIN_DIR ":$PATH; ";

}  // namespace

std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

ProgramResult run_program(const std::string& command, double seconds) {
  const testing::TemporaryFolder folder;
  const std::string line = fmt::format("{}exec timeout -k 2 {} {} >'{}' 2>'{}'", kPath, seconds, command,
                                       (folder / "out").string(), (folder / "err").string());
  ProgramResult result;
  result.exit_status = shell_status(std::system(line.c_str()));
  result.out = read_file(folder / "out");
  result.err = read_file(folder / "err");
  return result;
}

BackgroundProgram::BackgroundProgram(const std::string& command, std::string output_file)
    : output_file_(std::move(output_file)) {
  const std::string line = fmt::format("{}exec {} >'{}' 2>&1", kPath, command, output_file_);
  pid_ = fork();
  if (pid_ == 0) {
    execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    _exit(127);
  }
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
  return read_file(output_file_);
}

}  // namespace curbstone::system_test
