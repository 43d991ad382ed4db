#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/bus.hpp"
#include "common/counters.hpp"

namespace curbstone {

/// What a node tells the world about itself; the shell adds process facts and sends it as SERVICE_STATUS.
struct NodeReport {
  Counters counters;
  std::vector<std::string> faults;                                ///< what is wrong now, in words; empty when healthy
  double latency_p50 = std::numeric_limits<double>::quiet_NaN();  ///< s, of the node's work; NaN if it has none
  double latency_p99 = std::numeric_limits<double>::quiet_NaN();
};

/// A driver or service without its process: wires a core to typed messages. It acts on message time only, so that the
/// products of a replay are those of the live run. One thread calls everything.
class Node {
 public:
  virtual ~Node() = default;

  /// Subscribes to what the node needs. Called once, before anything else.
  virtual void connect(Subscriber& bus) = 0;

  /// Paced work: index pages, bounded publish rates. Live, `now` is the wall clock (every 20 ms); in a replay it is
  /// message time. What is published may depend on it, what it finally converges to may not.
  virtual void tick(std::int64_t now) { (void)now; }

  /// Live, all messages that had come have been handled: what they led to may go out now and not at the next tick. As
  /// with tick(), what is finally converged to does not depend on it; a replay does not call it.
  virtual void caught_up(std::int64_t now) { (void)now; }

  /// Live, there is nothing else to do: a small piece (1 to 2 ms) of work that may wait. Returns whether there may be
  /// more of it. As with caught_up(); what a replay must get done, tick() does too.
  virtual bool idle(std::int64_t now) {
    (void)now;
    return false;
  }

  /// Finish what is pending, without pacing: the drive is over. Called once before the process ends.
  virtual void finish() {}

  [[nodiscard]] virtual NodeReport report() const = 0;
};

}  // namespace curbstone
