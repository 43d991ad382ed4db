#pragma once

#include <optional>

#include "common/log/log_reader.hpp"
#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// Puts a fault into the messages of a log, one after the other, from the fault's time on.
class FaultyMessages {
 public:
  /// Nothing happens before `from`, s.
  FaultyMessages(Changes changes, double from) : changes_(std::move(changes)), from_(from) {}

  /// Changes a LIDAR_POINTS, IMU or WHEELS in place; other channels stay as they are. `t`: s since the drive's first
  /// message. Returns false if the message is not sent. Throws std::runtime_error if it cannot be decoded.
  [[nodiscard]] bool apply(double t, LogEvent& event);
  /// What a second sender sends beside a message, if there is one. Throws as apply().
  [[nodiscard]] std::optional<LogEvent> second(double t, const LogEvent& event);

 private:
  Changes changes_;
  double from_;
};

}  // namespace curbstone::bench::sensor_faults::catalogue
