#pragma once

#include "drivers/encoder/can/can_link.hpp"
#include "drivers/encoder/can/slcan_channel.hpp"
#include "drivers/serial/serial_link.hpp"

namespace curbstone::encoder::can {

/// A CAN bus behind a serial SLCAN adapter.
class SlcanLink final : public CanLink {
 public:
  /// `bitrate` in kbit/s of the bus. Waits for a port that is missing. Throws std::runtime_error with a one-line
  /// message for a bit rate or a file that is invalid.
  SlcanLink(const serial::SerialSettings& serial, int bitrate);

  void attach(EventLoop& loop, Handlers handlers) override;
  void send(const CanFrame& frame) override { channel_.send(frame); }
  void report(NodeReport& report) const override;

 private:
  Handlers handlers_;
  bool port_up_ = true;
  SlcanChannel channel_;
  serial::SerialLink serial_;
};

}  // namespace curbstone::encoder::can
