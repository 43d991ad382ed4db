#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/time/silence_timer.hpp"
#include "drivers/imu/xsens/xbus_frame.hpp"

namespace curbstone::imu::xsens {

/// Sets a device up and starts its measurement, and repeats this when it restarts or becomes silent. GotoConfig ->
/// SetOutputConfiguration -> GotoMeasurement: each is repeated until it is acknowledged, without a limit. Pure: time
/// and frames are arguments, commands go to `send`. All times in us. Source: Xsens MT Low Level Communication Protocol
/// (MT0101P). An error that the device reports while it measures is a fault for kErrorRemembered.
///
/// Counts: device.commands, device.retries, device.restarts (WakeUp seen), device.reconfigured, device.errors.
class MtConfigurator {
 public:
  using Send = std::function<void(std::span<const std::uint8_t>)>;
  struct Settings {
    bool enabled = true;  ///< false: never sends anything, the device is set up already
    int rate = 100;       ///< Hz
    bool orientation = true;
    std::int64_t patience = 1'000'000;  ///< us without a usable sample after which the device is set up again
  };

  static constexpr std::int64_t kErrorRemembered = 10'000'000;  ///< us

  MtConfigurator(const Settings& settings, Send send) : settings_(settings), send_(std::move(send)) {}

  /// (Re)starts from the beginning, when the link came up.
  void start(std::int64_t now);
  void on_frame(std::int64_t now, const XbusFrame& frame);
  /// A sample with all requested items was received.
  void on_usable_sample() { silence_.heard(); }
  void tick(std::int64_t now);

  /// The present fault in words; empty if there is none.
  [[nodiscard]] std::string fault() const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class Step { kGotoConfig, kSetOutputs, kGotoMeasurement, kMeasuring };

  void enter(Step step, std::int64_t now);
  void send_command(std::int64_t now);
  void check_outputs(std::span<const std::uint8_t> effective);
  void on_error(std::int64_t now, std::span<const std::uint8_t> data);

  Settings settings_;
  Send send_;
  Step step_ = Step::kGotoConfig;
  bool started_ = false;
  std::int64_t sent_ = 0;      // us, of the latest command
  SilenceTimer silence_;       // since a usable sample, else since the start of measurement
  int tries_ = 0;              // of the current command
  int unanswered_ = 0;         // commands since the last acknowledgement
  std::string refusal_;        // the device's latest error, until a set-up succeeds
  std::string error_;          // the device's latest error while it measures
  std::int64_t error_at_ = 0;  // us
  std::string mismatch_;       // how the outputs differ from the requested ones
  Counters counters_;
};

/// Data of SetOutputConfiguration for the items that the driver needs: counter, time, (orientation), acceleration, rate
/// of turn, status.
[[nodiscard]] std::vector<std::uint8_t> output_configuration(int rate, bool orientation);

}  // namespace curbstone::imu::xsens
