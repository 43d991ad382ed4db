#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/time/silence_timer.hpp"

namespace curbstone::imu::witmotion {

/// Sets a device up: which frames it sends, and at which rate. The protocol has no acknowledgement, so the set-up is
/// repeated if no usable sample comes for a while. Nothing is saved in the device: after a power cycle it has its
/// earlier settings. Pure; times in us. Source: WitMotion standard protocol, registers 02 (RSW) and 03 (RRATE).
///
/// Counts: device.commands, device.reconfigured.
class WitConfigurator {
 public:
  using Send = std::function<void(std::span<const std::uint8_t>)>;
  struct Settings {
    bool enabled = true;
    int rate = 100;  ///< Hz
    bool orientation = true;
    std::int64_t patience = 1'000'000;  ///< us
  };

  WitConfigurator(const Settings& settings, Send send);

  void start(std::int64_t now);
  /// A sample with time, acceleration and rate of turn was received.
  void on_usable_sample() { silence_.heard(); }
  void tick(std::int64_t now);
  /// Hz, the rate that is set in the device.
  [[nodiscard]] int rate() const { return rate_; }
  /// What the device does not support, in words; empty if there is nothing.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  Settings settings_;
  Send send_;
  std::vector<std::vector<std::uint8_t>> commands_;
  int rate_ = 0;  // Hz
  bool started_ = false;
  std::size_t next_ = 0;   // command
  std::int64_t sent_ = 0;  // us, of the previous command
  SilenceTimer silence_;   // since a usable sample, else since the end of the set-up
  std::string fault_;
  Counters counters_;
};

}  // namespace curbstone::imu::witmotion
