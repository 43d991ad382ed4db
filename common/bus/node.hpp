#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/counters.hpp"

namespace curbstone {

/// A node's own part of SERVICE_STATUS. The shell adds the process facts (pid, CPU time, memory) and sends it.
struct NodeReport {
  Counters counters;
  std::vector<std::string> faults;                                ///< present faults, in words; empty when healthy
  double latency_p50 = std::numeric_limits<double>::quiet_NaN();  ///< s, of the node's work; NaN if it measures none
  double latency_p99 = std::numeric_limits<double>::quiet_NaN();
};

/// A driver or service without its process: it connects a core to typed messages. It acts on message time only, so that
/// a replay makes the same products as the live run. One thread calls all functions, and none may throw. All times in
/// us since the Unix epoch.
class Node {
 public:
  virtual ~Node() = default;

  /// Subscribes to what the node needs. Called once, before anything else.
  virtual void connect(Subscriber& bus) = 0;

  /// Paced work: index pages, bounded publish rates. In a live run it is called every 20 ms and `now` is the wall
  /// clock. In a replay `now` is message time. The timing of publications may depend on it; the final state may not.
  virtual void tick(std::int64_t now) { (void)now; }

  /// The host's clock was set by `by` us since the last tick(), forward if positive. Measurements received in between
  /// may carry either time. Called in live runs only, before tick(), for nodes whose stamps depend on the host's clock.
  virtual void clock_was_set(std::int64_t by) { (void)by; }

  /// All messages that have arrived are handled: their results may be published without waiting for the next tick.
  /// Called in live runs only, not in a replay, so the final state may not depend on it.
  virtual void caught_up(std::int64_t now) { (void)now; }

  /// Does a small piece (1 to 2 ms) of work that may wait; called when there is nothing else to do. Returns whether
  /// more of it is left. Called in live runs only, as caught_up() is, so tick() must do the same work for a replay.
  virtual bool idle(std::int64_t now) {
    (void)now;
    return false;
  }

  /// The drive is over: no measurement follows. Called at most once. A replay then goes on with tick() until no node
  /// has anything outstanding.
  virtual void end_drive() {}

  /// How many things are still to be sent, or to be received from others, after end_drive(): 0 when all is complete.
  [[nodiscard]] virtual std::size_t num_outstanding() const { return 0; }

  /// Finishes pending work, without pacing. Called once before the process ends, in live runs without end_drive().
  virtual void finish() {}

  [[nodiscard]] virtual NodeReport report() const = 0;
};

}  // namespace curbstone
