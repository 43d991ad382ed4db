#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "common/shell/event_loop.hpp"
#include "drivers/serial/serial_port.hpp"

namespace curbstone::serial {

/// A serial port that is read from an event loop. If the device vanishes (unplugged, reset), the port is opened again,
/// with waits that grow from 0.1 s to 2 s. Bytes get their time of receipt here, us since the Unix epoch. One thread.
class SerialLink {
 public:
  struct Handlers {
    std::function<void(std::int64_t receive_utime, std::span<const std::uint8_t>)> on_bytes;
    /// Not called for the opening in the constructor. `why`, when it went down, is one line for people.
    std::function<void(std::int64_t now, bool up, const std::string& why)> on_link;
  };

  /// Opens the port: throws std::runtime_error, with one clear line, if that fails at start.
  explicit SerialLink(SerialSettings settings) : settings_(std::move(settings)), port_(SerialPort(settings_)) {}
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  /// Begins to read. The loop must not run after this object's end.
  void attach(EventLoop& loop, Handlers handlers);
  /// Bytes to the device. They are lost while there is none.
  void send(std::span<const std::uint8_t> bytes);

 private:
  void watch();
  void on_readable();
  void lose();
  void try_to_open();

  SerialSettings settings_;
  std::optional<SerialPort> port_;
  EventLoop* loop_ = nullptr;
  Handlers handlers_;
  std::int64_t retry_at_ = 0;     // us, steady clock
  std::int64_t retry_after_ = 0;  // us
  std::array<std::uint8_t, 4096> buffer_{};
};

}  // namespace curbstone::serial
