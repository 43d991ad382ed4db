#pragma once

#include <array>
#include <cstdint>
#include <curbstone/wheels_t.hpp>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/node.hpp"
#include "common/bus/refusal_share.hpp"
#include "common/time/settling_start.hpp"
#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/encoder/canopen/wheel_drive.hpp"
#include "drivers/encoder/encoder_config.hpp"
#include "drivers/encoder/first_period.hpp"
#include "drivers/encoder/period_clock.hpp"
#include "drivers/encoder/signals/wheel_signals.hpp"
#include "drivers/encoder/speed_counter.hpp"
#include "drivers/encoder/stuck_counts.hpp"
#include "drivers/encoder/two_senders.hpp"
#include "drivers/encoder/wheel_counter.hpp"
#include "drivers/encoder/wheels_output.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::encoder {

/// The CAN ids that a source must pass on; bit 31 marks a 29-bit id. Throws as EncoderNode does.
[[nodiscard]] std::vector<std::uint32_t> can_ids(const EncoderConfig& config);

/// Converts the CAN frames of a two-wheel drive, from any source, to WHEELS. It has no socket and no clock: frames come
/// with their time of receipt (us since the Unix epoch), and frames to the drive go to `send`. One thread.
///
/// PeriodClock makes the stamps: evenly spaced as the drive samples, not as frames arrive. They strictly increase,
/// unless the host's clock is set back. A sample waits until its time is certain. With `signals` the wheels are read
/// from raw frames and the drive is unknown: nothing is sent, and `enabled` is false. From a file the time is that of
/// the frames, whatever tick() gets. The first samples wait until their period is known (FirstPeriod), and for at least
/// 0.1 s (SettlingStart).
class EncoderNode final : public Node {
 public:
  using Send = std::function<void(const can::CanFrame&)>;

  /// Throws std::runtime_error with a one-line message for invalid signals.
  EncoderNode(
      const EncoderConfig& config, Publisher& bus, Send send = [](const can::CanFrame&) {});

  void connect(Subscriber&) override {}
  void on_frame(std::int64_t receive_utime, const can::CanFrame& frame);
  /// Up: frames can be sent from this time on (assumed at the start), and the drive is set up. Down: the adapter or
  /// interface is not ready or has vanished, and `why` gives the reason in one line.
  void on_link(std::int64_t now, link::LinkState state, const std::string& why);
  /// The link refused a line or a frame; `cause` is the counter's name.
  void on_refused(std::int64_t now, const char* cause) { share_.refused(now, cause); }
  void clock_was_set(std::int64_t by) override;
  void tick(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  /// Called by report(), to add the counters and faults of the link.
  void add_report(std::function<void(NodeReport&)> add) { add_report_ = std::move(add); }

 private:
  using Sample = std::optional<WheelCounter::Sample>;
  void on_counts(std::int64_t receive_utime, const WheelCounter::Raw& counts);
  void on_signals(std::int64_t receive_utime, const can::CanFrame& frame);
  using Update = std::function<Sample(double elapsed)>;
  struct Arrived {  // waits for its stamp
    std::int64_t receive_utime;
    Update update;
    std::array<std::uint16_t, 2> faults;
    bool enabled;
    bool stuck;  // neither count is usable
  };
  struct HeldSample {  // waits for the period
    Arrived arrived;
    PeriodClock::Evidence evidence;
  };
  [[nodiscard]] bool may_have_wrapped(std::int64_t gap) const;
  void on_sample(std::int64_t receive_utime, PeriodClock::Evidence evidence, Update update);
  void stamp(Arrived arrived, const PeriodClock::Evidence& evidence);
  void release_held();
  void drop_held();
  void forget_counts();
  void restart_counting();
  void on_stamp(std::int64_t now, const Arrived& arrived, const PeriodClock::Stamp& stamp);

  EncoderConfig config_;
  canopen::WheelDrive drive_;                     // idle if there are signals
  std::optional<signals::WheelSignals> signals_;  // instead of a CANopen drive
  WheelCounter odometer_;
  SpeedCounter speedometer_;
  StuckCounts stuck_;
  TwoSenders senders_;
  FirstPeriod first_period_;
  bool period_known_ = false;
  std::vector<HeldSample> held_;
  PeriodClock clock_;
  SettlingStart<wheels_t> start_;
  WheelsOutput output_;
  std::deque<Arrived> waiting_;
  std::int64_t last_received_ = 0;  // counts
  std::int64_t last_stamped_ = 0;   // time of receipt
  std::optional<WheelCounter::Raw> last_counts_;
  std::optional<double> last_step_;  // counts, to those from the ones before
  std::int64_t began_ = 0;
  std::int64_t now_ = 0;
  std::int64_t last_frame_ = 0;  // received
  std::string link_fault_;
  bool replugged_ = false;  // no signal since the link was reopened
  RefusalShare share_;
  const char* refusal_ = nullptr;  // why the current frame was refused
  std::function<void(NodeReport&)> add_report_;
  Counters counters_;
};

}  // namespace curbstone::encoder
