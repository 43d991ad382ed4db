#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace curbstone::simulate::live {

/// The device's end of a pseudo-terminal. The host's end is a tty that drivers open like any serial port, under a
/// chosen name (a symlink). It stays open without a process at the other end. Neither copied nor moved.
class Pty {
 public:
  /// Throws std::runtime_error with a one-line message.
  explicit Pty(const std::string& link);
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  [[nodiscard]] int fd() const { return fd_; }
  /// Bytes written by the host, if any. Never blocks.
  [[nodiscard]] std::vector<std::uint8_t> read();
  /// Never blocks: if no process reads, the line's buffer fills and bytes are lost, as on a real line. Returns the
  /// number of bytes written.
  std::size_t write(std::span<const std::uint8_t> bytes);

 private:
  std::string link_;
  int fd_ = -1;
  int host_end_ = -1;  // kept open, so that the device's end sees no hang-up between two hosts
};

}  // namespace curbstone::simulate::live
