#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "common/bus/node.hpp"
#include "common/shell/event_loop.hpp"
#include "common/time/retry_backoff.hpp"
#include "drivers/link/link_state.hpp"
#include "drivers/serial/send_queue.hpp"
#include "drivers/serial/serial_port.hpp"

namespace curbstone::serial {

/// A serial port in an event loop. If the device is missing, at the start or later (unplugged, reset), the port is
/// reopened, with a back-off from 0.1 s to 2 s. The link stamps bytes with their time of receipt, us since the Unix
/// epoch. One thread.
class SerialLink {
 public:
  struct Handlers {
    std::function<void(std::int64_t receive_utime, std::span<const std::uint8_t>)> on_bytes;
    /// Not called if the port is open when the link is attached. `why`, if it is down, is one line for the operator.
    std::function<void(std::int64_t now, link::LinkState state, const std::string& why)> on_link;
  };

  /// Opens the port if the device is present. Throws NotASerialPort with a one-line message: only the config can fix
  /// that.
  explicit SerialLink(SerialSettings settings);
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  /// Begins to read; reports at once if there is no device. The loop must not run after this object is destroyed.
  void attach(EventLoop& loop, Handlers handlers);
  /// Sends one message to the device. What the kernel does not accept at once is sent when it has room. The message is
  /// dropped and counted while there is no device, and if more than SendQueue::kMaxBytes bytes are waiting.
  void send(std::span<const std::uint8_t> bytes);

  /// Adds serial.baud, serial.low_latency (0, 1), serial.latency_timer_ms, serial.low_latency_refused (openings),
  /// dropped.serial_away and dropped.serial_full (messages), and a fault if the port runs at another baud.
  void report(NodeReport& report) const;

 private:
  void open();
  void watch();
  void on_readable();
  void on_writable();
  void lose();
  void try_to_open();

  SerialSettings settings_;
  std::optional<SerialPort> port_;
  std::string why_;  // reason why there is no port
  EventLoop* loop_ = nullptr;
  Handlers handlers_;
  SendQueue queue_;
  RetryBackoff retry_;
  Counters counters_;
  std::array<std::uint8_t, 4096> buffer_{};
};

}  // namespace curbstone::serial
