#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "common/bus/node.hpp"
#include "common/shell/event_loop.hpp"
#include "drivers/encoder/modbus/drive_poll.hpp"
#include "drivers/encoder/modbus/modbus_client.hpp"

namespace curbstone::encoder::modbus {

/// Polls a drive from a thread of its own, for libmodbus waits for each reply. Readings come to the event loop's thread
/// by a bounded queue and an eventfd, so the loop never waits for the bus. Opens the port, and again when it is gone or
/// nothing useful comes, with waits that grow from 0.1 s to 1 s. A port that is not there at the start is a fault like
/// one that goes later. The destructor ends the thread, within about three timeouts.
///
/// Counts: those of DrivePoll, modbus.openings, dropped.queue (the loop did not take readings in time).
class ModbusLink {
 public:
  struct Handlers {
    std::function<void(const Reading&)> on_reading;
    /// `why`, when it is not up, is one line for people.
    std::function<void(bool up, const std::string& why)> on_link;
  };
  static constexpr std::size_t kMaxQueue = 200;  ///< readings: four seconds

  /// `rate` Hz of the polls. Throws std::runtime_error with one clear line if libmodbus cannot use the settings.
  ModbusLink(const ModbusSettings& settings, double rate);
  ~ModbusLink();
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;

  /// Begins to poll. The loop must not run after this object's end.
  void attach(EventLoop& loop, Handlers handlers);
  /// Adds counters and faults.
  void report(NodeReport& report) const;

 private:
  struct Event {
    std::optional<Reading> reading;  // or the link has changed:
    bool up = false;
    std::string why;
  };

  void run(const std::stop_token& stop);
  bool open(const std::stop_token& stop);
  void tell(Event event);
  void share_report();
  bool sleep_until(std::int64_t time, const std::stop_token& stop);
  void on_readable();

  ModbusSettings settings_;
  std::int64_t period_;  // us
  Handlers handlers_;
  int event_fd_ = -1;

  // The thread's own:
  ModbusClient client_;
  DrivePoll poll_;
  std::int64_t openings_ = 0;

  // Of both threads:
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Event> queue_;
  std::int64_t dropped_ = 0;
  Counters counters_;
  std::string fault_;
  std::optional<std::string> share_fault_;

  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace curbstone::encoder::modbus
