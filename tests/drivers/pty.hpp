#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace curbstone::test {

/// A pseudo-terminal whose other end has a name that stays: a device that can be unplugged and plugged in again.
class Pty {
 public:
  Pty() { plug(); }
  ~Pty() { unplug(); }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  [[nodiscard]] std::string path() const { return path_; }
  [[nodiscard]] int fd() const { return fd_; }

  void plug() {
    fd_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0) throw std::runtime_error("no pseudo-terminal");
    termios settings{};
    tcgetattr(fd_, &settings);
    cfmakeraw(&settings);
    tcsetattr(fd_, TCSANOW, &settings);
    std::filesystem::remove(path_);
    std::filesystem::create_symlink(ptsname(fd_), path_);
  }
  void unplug() {
    std::filesystem::remove(path_);
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  void write(std::span<const std::uint8_t> bytes) const {
    if (fd_ >= 0 && !bytes.empty()) [[maybe_unused]]
      const auto written = ::write(fd_, bytes.data(), bytes.size());
  }
  [[nodiscard]] std::vector<std::uint8_t> read() const {
    std::vector<std::uint8_t> bytes(4096);
    const ssize_t size = fd_ >= 0 ? ::read(fd_, bytes.data(), bytes.size()) : 0;
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return bytes;
  }
  /// Waits up to a second for something to read.
  [[nodiscard]] std::vector<std::uint8_t> wait_and_read() const {
    pollfd wait{fd_, POLLIN, 0};
    poll(&wait, 1, 1000);
    return read();
  }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "device";
  int fd_ = -1;
};

}  // namespace curbstone::test
