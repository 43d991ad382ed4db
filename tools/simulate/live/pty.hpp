#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace curbstone::simulate::live {

/// The device's end of a pseudo-terminal; the host's end is a tty that drivers open like any serial port, under a name
/// of our choosing (a symlink). Stays open while nobody is at the other end. Move-only in spirit: neither copied nor
/// moved.
class Pty {
 public:
  /// Throws std::runtime_error with one clear line.
  explicit Pty(const std::string& link);
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  [[nodiscard]] int fd() const { return fd_; }
  /// What the host wrote, if anything. Never blocks.
  [[nodiscard]] std::vector<std::uint8_t> read();
  /// Never blocks: when nobody reads, the line's buffer fills and bytes are lost, as on a real line. Returns how many.
  std::size_t write(std::span<const std::uint8_t> bytes);

 private:
  std::string link_;
  int fd_ = -1;
  int host_end_ = -1;  // kept open, so that our end sees no hang-up between two hosts
};

}  // namespace curbstone::simulate::live
