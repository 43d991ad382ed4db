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
#include "drivers/link/link_state.hpp"

namespace curbstone::encoder::modbus {

/// Polls a drive in a thread of its own, because libmodbus blocks until each reply. Readings reach the event loop's
/// thread by a bounded queue and an eventfd, so the loop never waits for the bus. Opens the port, and reopens it when
/// it has vanished or nothing useful is received, with a back-off from 0.1 s to 1 s. A port that is missing at the
/// start is a fault like one that vanishes later. The destructor ends the thread within about three time-outs.
///
/// Counts: those of DrivePoll, modbus.openings, serial.low_latency, serial.latency_timer_ms (levels), dropped.queue
/// (readings that the loop did not take in time).
class ModbusLink {
 public:
  struct Handlers {
    std::function<void(const Reading&)> on_reading;
    /// `why`, if the link is down, is one line for the operator.
    std::function<void(link::LinkState state, const std::string& why)> on_link;
  };
  static constexpr std::size_t kMaxQueue = 200;  ///< readings: four seconds

  /// `rate` of the polls in Hz. Throws std::runtime_error with a one-line message if libmodbus cannot use the settings.
  ModbusLink(const ModbusSettings& settings, double rate);
  ~ModbusLink();
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;

  /// Begins to poll. The loop must not run after this object is destroyed.
  void attach(EventLoop& loop, Handlers handlers);
  /// Adds counters and faults.
  void report(NodeReport& report) const;

 private:
  struct Event {
    std::optional<Reading> reading;  // if empty, the link has changed:
    link::LinkState link = link::LinkState::kDown;
    std::string why;
  };

  void run(const std::stop_token& stop);
  bool open(const std::stop_token& stop);
  void post(Event event);
  void share_report();
  bool sleep_until(std::int64_t time, const std::stop_token& stop);
  void on_readable();

  ModbusSettings settings_;
  std::int64_t period_;  // us
  Handlers handlers_;
  int event_fd_ = -1;

  // Used by the thread only:
  ModbusClient client_;
  DrivePoll poll_;
  std::int64_t openings_ = 0;

  // Shared by both threads:
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Event> queue_;
  std::int64_t dropped_ = 0;
  Counters counters_;
  std::string fault_;
  std::optional<std::string> share_fault_;

  std::jthread thread_;  // declared last: it ends before the members that it uses
};

}  // namespace curbstone::encoder::modbus
