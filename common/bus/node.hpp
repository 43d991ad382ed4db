#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/counters.hpp"

namespace curbstone {

/// A node's own part of SERVICE_STATUS. The shell adds the facts of the process (pid, CPU time, memory) and sends it.
struct NodeReport {
  Counters counters;
  std::vector<std::string> faults;                                ///< what is wrong now, in words; empty when healthy
  double latency_p50 = std::numeric_limits<double>::quiet_NaN();  ///< s, of the node's work; NaN if it has none
  double latency_p99 = std::numeric_limits<double>::quiet_NaN();
};

/// A driver or service without its process: it wires a core to typed messages. It acts on message time only. So a
/// replay makes the same products as the live run. One thread calls everything, and nothing may throw. All times in us
/// since the Unix epoch.
class Node {
 public:
  virtual ~Node() = default;

  /// Subscribes to what the node needs. Called once, before anything else.
  virtual void connect(Subscriber& bus) = 0;

  /// Paced work: index pages, bounded publish rates. Live it is called every 20 ms, and `now` is the wall clock. In a
  /// replay `now` is message time. What is published when may depend on it. The final state may not.
  virtual void tick(std::int64_t now) { (void)now; }

  /// The host's clock was set by `by` us, forward if positive, since the last tick(): measurements that came meanwhile
  /// may bear either time. Called live only, before tick(), for nodes whose stamps hang on the host's clock.
  virtual void clock_was_set(std::int64_t by) { (void)by; }

  /// All messages that had come have been handled: their results may go out without waiting for the next tick. Called
  /// live only, not in a replay. So the final state may not depend on it.
  virtual void caught_up(std::int64_t now) { (void)now; }

  /// Nothing else is to be done: a small piece (1 to 2 ms) of work that may wait. Returns whether more of it is left.
  /// Called live only, as caught_up() is. So tick() must do the same work, for a replay.
  virtual bool idle(std::int64_t now) {
    (void)now;
    return false;
  }

  /// The drive is over: finishes what is pending, without pacing. Called once before the process ends.
  virtual void finish() {}

  [[nodiscard]] virtual NodeReport report() const = 0;
};

}  // namespace curbstone
