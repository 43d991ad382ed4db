#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/event_loop.hpp"
#include "common/node.hpp"
#include "drivers/encoder/can_frame.hpp"

namespace curbstone {

/// A way to a CAN bus that a process lives with: it comes back by itself when the adapter or interface does. Shell:
/// this is where frames get the time of receipt.
class CanLink {
 public:
  struct Handlers {
    std::function<void(std::int64_t receive_utime, const CanFrame&)> on_frame;
    /// Frames can be sent from now on; or not, and `why`, one line for people.
    std::function<void(std::int64_t now, bool up, const std::string& why)> on_link;
  };

  virtual ~CanLink() = default;
  /// Begins to read. The loop must not run after this object's end.
  virtual void attach(EventLoop& loop, Handlers handlers) = 0;
  /// Lost, and counted, while the link is down.
  virtual void send(const CanFrame& frame) = 0;
  /// Adds counters and faults.
  virtual void report(NodeReport& report) const = 0;
};

}  // namespace curbstone
