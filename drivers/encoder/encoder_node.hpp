#pragma once

#include <array>
#include <cstdint>
#include <curbstone/wheels_t.hpp>
#include <functional>
#include <string>

#include "common/latency.hpp"
#include "common/node.hpp"
#include "common/settling_start.hpp"
#include "drivers/encoder/can_frame.hpp"
#include "drivers/encoder/encoder_config.hpp"
#include "drivers/encoder/period_clock.hpp"
#include "drivers/encoder/wheel_counter.hpp"
#include "drivers/encoder/wheel_drive.hpp"

namespace curbstone {

/// CAN frames of a two-wheel drive in, from whatever source, WHEELS out. No socket and no clock: frames come with the
/// time of their receipt, frames to the drive leave through `send`.
///
/// Stamps are those of PeriodClock: even, as the drive samples, not as frames arrive. They strictly increase, unless
/// somebody sets the host's clock back. Samples of the first 0.1 s go out at its end: see SettlingStart.
class EncoderNode final : public Node {
 public:
  using Send = std::function<void(const CanFrame&)>;

  EncoderNode(
      const EncoderConfig& config, Publisher& bus, Send send = [](const CanFrame&) {});

  void connect(Subscriber&) override {}
  void on_frame(std::int64_t receive_utime, const CanFrame& frame);
  /// Frames can be sent from now on (assumed at first); or the adapter or interface is not ready, or has vanished:
  /// `why`. The drive is set up at each `up`.
  void on_link(std::int64_t now, bool up, const std::string& why);
  void tick(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  /// Something else to say in report(): the source's counters and faults.
  void add_report(std::function<void(NodeReport&)> add) { add_report_ = std::move(add); }

 private:
  void on_counts(std::int64_t receive_utime, const WheelCounter::Raw& counts);
  void publish(wheels_t& message, std::int64_t now);

  EncoderConfig config_;
  Publisher& bus_;
  WheelDrive drive_;
  WheelCounter odometer_;
  PeriodClock clock_;
  SettlingStart<wheels_t> start_;
  std::int32_t sequence_ = 0;
  std::int64_t last_utime_ = 0;     // published
  std::int64_t last_received_ = 0;  // counts
  std::int64_t now_ = 0;
  std::string link_fault_;
  std::function<void(NodeReport&)> add_report_;
  LatencyWindow latency_;
  Counters counters_;
};

}  // namespace curbstone
