#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/bus/node.hpp"
#include "common/shell/event_loop.hpp"
#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::encoder::can {

/// Interface of a link to a CAN bus. It recovers by itself when the adapter or interface vanishes and comes back. The
/// link stamps frames with their time of receipt, us since the Unix epoch. One thread, that of the event loop.
class CanLink {
 public:
  struct Handlers {
    std::function<void(std::int64_t receive_utime, const CanFrame&)> on_frame;
    /// Up: frames can be sent from this time on. Down: they cannot, and `why` gives the reason in one line.
    std::function<void(std::int64_t now, link::LinkState state, const std::string& why)> on_link;
    /// A line or a frame was refused; `cause` is the counter's name.
    std::function<void(std::int64_t now, const char* cause)> on_refused = [](std::int64_t, const char*) {};
  };

  virtual ~CanLink() = default;
  /// Begins to read. The loop must not run after this object is destroyed.
  virtual void attach(EventLoop& loop, Handlers handlers) = 0;
  /// A frame is lost, and counted, while the link is down.
  virtual void send(const CanFrame& frame) = 0;
  /// Adds counters and faults.
  virtual void report(NodeReport& report) const = 0;
};

}  // namespace curbstone::encoder::can
