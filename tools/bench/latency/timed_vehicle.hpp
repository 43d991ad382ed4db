#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/log/log_reader.hpp"
#include "tools/bench/latency/timed_process.hpp"

namespace curbstone::bench::latency {

struct TimedVehicleOptions {
  std::string config_file;               ///< the vehicle's YAML file; empty: defaults
  std::vector<std::string> assignments;  ///< SECTION.KEY=VALUE, override the file
  std::string map_file;                  ///< empty: the map is only in memory
  int cores = 2;                         ///< shared by the services
};

/// Filter, mapper, one voting worker and the semantic map as simulated processes on a few cores, fed by a log of the
/// drivers' messages at their recorded times. Only CPU time advances the simulated clocks, so a busy machine measures
/// the same as an idle one.
class TimedVehicle {
 public:
  /// Gets every message, including those of the log, with the time at which it is on the bus; not always in time order.
  using Listener = std::function<void(const TimedMessage&)>;
  TimedVehicle(const TimedVehicleOptions& options, Listener listener);

  /// Feeds a message of the drivers; call in time order.
  void sense(const LogEvent& event);

  /// Name and process, in the order of the data flow.
  [[nodiscard]] const std::vector<std::pair<std::string, std::unique_ptr<TimedProcess>>>& processes() const {
    return processes_;
  }

 private:
  void advance(std::int64_t to);
  void send(const TimedMessage& message);
  Listener listener_;
  std::vector<std::pair<std::string, std::unique_ptr<TimedProcess>>> processes_;
  std::vector<std::int64_t> cores_;  // us, when each becomes free
  std::int64_t now_ = 0;
};

}  // namespace curbstone::bench::latency
