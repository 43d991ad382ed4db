#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <functional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/node.hpp"
#include "common/shell/duplicate_process.hpp"
#include "common/shell/fault_lines.hpp"
#include "common/shell/second_process.hpp"
#include "common/time/clock.hpp"
#include "common/time/clock_step.hpp"

namespace curbstone {

[[nodiscard]] std::string host_name();

/// The clocks of a process, us; tests replace them.
struct Clocks {
  std::function<std::int64_t()> wall = wall_clock;
  std::function<std::int64_t()> steady = steady_clock;
};

/// Sends SERVICE_STATUS for a process: its node's report, the process facts, whether the host's clock was set, and
/// whether another process has the same name, or its task. The beginning and end of persistent faults are also printed.
/// Call it from the loop that does the work, so that a status proves that the loop runs.
class StatusReporter {
 public:
  using Print = std::function<void(const std::string& line)>;
  /// `service`: unique on the bus. `print`: empty: to stderr.
  StatusReporter(std::string service, std::string config_hash, Clocks clocks = {}, Print print = {});

  /// Whether the node's faults differ from those sent last, apart from numbers. Such a change is sent at once, so that
  /// a process that waits for a service need not wait for the next second.
  [[nodiscard]] bool faults_changed(const NodeReport& report) const;
  /// Takes any SERVICE_STATUS on the bus.
  void on_status(const service_status_t& message) { duplicate_.on_status(message, status_, clocks_.wall()); }
  /// Takes any CONFIG on the bus, for a process of which there may be one: see SecondProcess. `own`: that of this one.
  void on_config(const service_config_t& message, const service_config_t& own) {
    section_ = own.section;
    second_.on_config(message, own, clocks_.wall());
  }
  void publish(Publisher& bus, const Counters& bus_counters, const NodeReport& report);

 private:
  Clocks clocks_;
  Print print_;
  service_status_t status_{};
  std::vector<std::string> reported_;  // the node's faults, without their numbers
  FaultLines fault_lines_;
  ClockStep clock_step_;
  DuplicateProcess duplicate_;
  SecondProcess second_;
  std::string section_;
  std::int64_t start_;  // us
};

}  // namespace curbstone
