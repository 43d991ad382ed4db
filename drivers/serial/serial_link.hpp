#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "common/bus/node.hpp"
#include "common/shell/event_loop.hpp"
#include "common/time/retry_pause.hpp"
#include "drivers/serial/send_queue.hpp"
#include "drivers/serial/serial_port.hpp"

namespace curbstone::serial {

/// A serial port that is read from an event loop. If the device is missing, at the start or later (unplugged, reset),
/// the port is opened again, with waits that grow from 0.1 s to 2 s. Bytes get their time of receipt here, us since the
/// Unix epoch. One thread.
class SerialLink {
 public:
  struct Handlers {
    std::function<void(std::int64_t receive_utime, std::span<const std::uint8_t>)> on_bytes;
    /// Not called if the port is open when the link is attached. `why`, when it is down, is one line for people.
    std::function<void(std::int64_t now, bool up, const std::string& why)> on_link;
  };

  /// Opens the port, if the device is there. Throws NotASerialPort, with one clear line: only the config mends that.
  explicit SerialLink(SerialSettings settings);
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  /// Begins to read; tells at once if there is no device. The loop must not run after this object's end.
  void attach(EventLoop& loop, Handlers handlers);
  /// One message to the device. What the kernel does not take at once is sent as it makes room. The message is lost,
  /// and counted, while there is no device, and if more than SendQueue::kMost bytes wait.
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
  std::string why_;  // there is no port
  EventLoop* loop_ = nullptr;
  Handlers handlers_;
  SendQueue queue_;
  RetryPause retry_;
  Counters counters_;
  std::array<std::uint8_t, 4096> buffer_{};
};

}  // namespace curbstone::serial
