#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "drivers/serial/low_latency.hpp"

namespace curbstone::serial {

struct SerialSettings {
  std::string device = "/dev/ttyUSB0";
  int baud = 115200;
  bool low_latency = true;  ///< ask the port's driver not to hold bytes back
};

/// The name is that of something else than a serial port: waiting does not fix that.
class NotASerialPort : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A serial port in raw mode, 8N1, no flow control, non-blocking, opened exclusively. Move-only; closed by the
/// destructor.
class SerialPort {
 public:
  /// Throws std::runtime_error with a one-line message: no such device, no permission, busy; NotASerialPort.
  explicit SerialPort(const SerialSettings& settings);
  ~SerialPort();
  SerialPort(SerialPort&& other) noexcept;
  SerialPort& operator=(SerialPort&& other) noexcept;

  [[nodiscard]] int fd() const { return fd_; }
  /// As reported by the driver; 0 if it reports none.
  [[nodiscard]] int baud() const { return baud_; }
  /// What was granted; nothing if it was not requested.
  [[nodiscard]] const LowLatency& low_latency() const { return low_latency_; }

  enum class Status { kData, kNothing, kGone };
  struct Read {
    Status status = Status::kNothing;
    std::size_t size = 0;
  };
  /// Reads what has arrived, up to the buffer's size.
  [[nodiscard]] Read read(std::span<std::uint8_t> buffer);
  /// Returns the number of bytes accepted by the kernel: fewer if its queue is full or the device has vanished.
  std::size_t write(std::span<const std::uint8_t> bytes);

 private:
  void close() noexcept;

  int fd_ = -1;
  int baud_ = 0;
  LowLatency low_latency_;
};

}  // namespace curbstone::serial
