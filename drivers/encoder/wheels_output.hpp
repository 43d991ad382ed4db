#pragma once

#include <cstdint>
#include <curbstone/wheels_t.hpp>

#include "common/bus/bus.hpp"
#include "common/bus/node.hpp"
#include "common/shell/latency.hpp"
#include "common/time/arrival_gap.hpp"
#include "drivers/encoder/wheel_counter.hpp"

namespace curbstone::encoder {

/// Publishes WHEELS, from any way of reading them: with sequence numbers and increasing stamps. One thread.
///
/// Counts: samples, dropped.not_newer, clock_jumps; clock.difference_us.
class WheelsOutput {
 public:
  explicit WheelsOutput(Publisher& bus) : bus_(bus) {}

  /// A message with the sample's counts, angles and speeds.
  [[nodiscard]] static wheels_t message(const WheelCounter::Sample& sample, std::int64_t utime);
  /// `now`: time of receipt, us since the Unix epoch, for the latency.
  void publish(wheels_t& message, std::int64_t now);
  /// The stamps restart at `utime`: if that is earlier by 0.1 s, the host's clock was set.
  void restart(std::int64_t utime);
  /// Adds counters, latencies, and a fault if the stamps are not on the host's clock.
  void report(NodeReport& report) const;

 private:
  Publisher& bus_;
  std::int32_t sequence_ = 0;
  std::int64_t last_utime_ = 0;
  LatencyWindow latency_;
  ArrivalGap arrival_;
  Counters counters_;
};

}  // namespace curbstone::encoder
