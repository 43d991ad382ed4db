#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/node.hpp"
#include "common/shell/fault_lines.hpp"
#include "common/time/clock_step.hpp"

namespace curbstone {

[[nodiscard]] std::string host_name();

/// Sends SERVICE_STATUS for a process: what its node reports, and the facts of the process: that the clock
/// of the host was set, too. Faults that come to stay,
/// or are over, also go to stderr. Call it from the loop that does the work: its coming says that the loop turns.
class StatusReporter {
 public:
  /// `service`: unique on the bus.
  StatusReporter(std::string service, std::string config_hash);

  void publish(Publisher& bus, const Counters& bus_counters, const NodeReport& report);

 private:
  service_status_t status_{};
  FaultLines fault_lines_;
  ClockStep clock_step_;
  std::int64_t start_;  // us
};

}  // namespace curbstone
