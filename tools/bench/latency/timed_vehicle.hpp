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
  std::vector<std::string> assignments;  ///< SECTION.KEY=VALUE, over the file
  std::string map_file;                  ///< empty: the map lives in memory only
  int cores = 2;                         ///< that the services share
};

/// Filter, mapper, one voting worker and the semantic map as processes on few cores, fed by a log of the drivers'
/// messages as these came. Only CPU time counts: a clock of its own, so that a busy machine measures the same as an
/// idle one.
class TimedVehicle {
 public:
  /// Hears every message at the time at which it is on the bus, those of the log too, not always in order of time.
  using Listener = std::function<void(const TimedMessage&)>;
  TimedVehicle(const TimedVehicleOptions& options, Listener listener);

  /// A message of the drivers; in order of their times.
  void sense(const LogEvent& event);

  /// Name and process, in the order of the data's flow.
  [[nodiscard]] const std::vector<std::pair<std::string, std::unique_ptr<TimedProcess>>>& processes() const {
    return processes_;
  }

 private:
  void advance(std::int64_t to);
  void send(const TimedMessage& message);
  Listener listener_;
  std::vector<std::pair<std::string, std::unique_ptr<TimedProcess>>> processes_;
  std::vector<std::int64_t> cores_;  // us, when each is free
  std::int64_t now_ = 0;
};

}  // namespace curbstone::bench::latency
