#include "tools/simulate/live/pty.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace curbstone::simulate::live {

Pty::Pty(const std::string& link) : link_(link), fd_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  std::array<char, 128> name{};
  if (fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0 || ptsname_r(fd_, name.data(), name.size()) != 0) {
    const int error = errno;
    if (fd_ >= 0) close(fd_);
    throw std::runtime_error(fmt::format("no pseudo-terminal for {}: {}", link, std::strerror(error)));
  }
  host_end_ = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios raw{};
  tcgetattr(fd_, &raw);
  cfmakeraw(&raw);
  tcsetattr(fd_, TCSANOW, &raw);

  // Creates the link atomically, so that a waiting process never finds it half made. Only an existing link is replaced.
  std::error_code error;
  const bool taken = std::filesystem::exists(std::filesystem::symlink_status(link, error)) &&
                     !std::filesystem::is_symlink(std::filesystem::symlink_status(link, error));
  const std::string fresh = fmt::format("{}.{}", link, getpid());
  if (!taken) {
    std::filesystem::create_symlink(name.data(), fresh, error);
    if (!error) std::filesystem::rename(fresh, link, error);
  }
  if (taken || error) {
    close(fd_);
    close(host_end_);
    throw std::runtime_error(fmt::format("{}: cannot be made a link to {}: {}", link, name.data(),
                                         taken ? "a file is there" : error.message()));
  }
}

Pty::~Pty() {
  std::error_code ignored;
  std::filesystem::remove(link_, ignored);
  if (host_end_ >= 0) close(host_end_);
  close(fd_);
}

std::vector<std::uint8_t> Pty::read() {
  std::array<std::uint8_t, 4096> buffer;
  const ssize_t size = ::read(fd_, buffer.data(), buffer.size());
  return size > 0 ? std::vector<std::uint8_t>(buffer.data(), buffer.data() + size) : std::vector<std::uint8_t>{};
}

std::size_t Pty::write(std::span<const std::uint8_t> bytes) {
  // Bytes that stay unread are lost on a real line: a host that opens the port now must not get old bytes.
  constexpr int kUnread = 2048;
  int unread = 0;
  if (ioctl(host_end_, FIONREAD, &unread) == 0 && unread > kUnread) tcflush(host_end_, TCIFLUSH);
  const ssize_t size = ::write(fd_, bytes.data(), bytes.size());
  return size > 0 ? static_cast<std::size_t>(size) : 0;
}

}  // namespace curbstone::simulate::live
