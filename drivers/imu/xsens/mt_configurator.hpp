#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "drivers/imu/xsens/xbus_frame.hpp"

namespace curbstone::imu::xsens {

/// Sets a device up and starts its measurement, and does so again whenever it restarts or falls silent. GotoConfig ->
/// SetOutputConfiguration -> GotoMeasurement: each is repeated until it is acknowledged, without end. Pure: time comes
/// in, command bytes go out. All times in us. Source: Xsens MT Low Level Communication Protocol (MT0101P).
///
/// Counts: device.commands, device.retries, device.restarts (WakeUp seen), device.reconfigured, device.errors.
class MtConfigurator {
 public:
  using Send = std::function<void(std::span<const std::uint8_t>)>;
  struct Settings {
    bool enabled = true;  ///< false: never sends anything, the device was set up by somebody else
    int rate = 100;       ///< Hz
    bool orientation = true;
    std::int64_t patience = 1'000'000;  ///< us without a usable sample after which the device is set up again
  };

  MtConfigurator(const Settings& settings, Send send) : settings_(settings), send_(std::move(send)) {}

  /// (Re)starts from the beginning: the link came up.
  void start(std::int64_t now);
  void on_frame(std::int64_t now, const XbusFrame& frame);
  /// A sample with everything that was asked for has come.
  void on_usable_sample(std::int64_t now) { last_usable_ = now; }
  void tick(std::int64_t now);

  [[nodiscard]] bool measuring() const { return step_ == Step::kMeasuring; }
  /// What is wrong, in words; empty when nothing is.
  [[nodiscard]] std::string fault() const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class Step { kGotoConfig, kSetOutputs, kGotoMeasurement, kMeasuring };

  void enter(Step step, std::int64_t now);
  void send_command(std::int64_t now);
  void check_outputs(std::span<const std::uint8_t> effective);
  void on_error(std::span<const std::uint8_t> data);

  Settings settings_;
  Send send_;
  Step step_ = Step::kGotoConfig;
  bool started_ = false;
  std::int64_t sent_ = 0;         // when the last command went out
  std::int64_t last_usable_ = 0;  // when the last usable sample came, or measurement began
  int tries_ = 0;                 // of the present command
  int unanswered_ = 0;            // commands since the last acknowledgement
  std::string refusal_;           // the device's last error, until a set-up succeeds
  std::string mismatch_;          // how the outputs differ from what was asked
  Counters counters_;
};

/// The data of SetOutputConfiguration for what the driver needs: counter, time, (orientation), acceleration, rate of
/// turn, status.
[[nodiscard]] std::vector<std::uint8_t> output_configuration(int rate, bool orientation);

}  // namespace curbstone::imu::xsens
