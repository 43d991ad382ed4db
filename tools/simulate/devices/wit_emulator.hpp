#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::simulate::devices {

/// A WitMotion IMU seen from its serial line: streams from power-up, accepts the registers for its frames (02) and rate
/// (03) once it is unlocked, and loses both with its supply. A byte state machine without a clock, like XsensEmulator.
class WitEmulator {
 public:
  /// Switches the supply on: its time of day begins at midnight.
  void power_on(std::int64_t now);
  void on_bytes(std::span<const std::uint8_t> bytes);
  /// The frames of one sample.
  std::vector<std::uint8_t> sample(std::int64_t now, const XsensSample& sample);
  /// us between samples.
  [[nodiscard]] std::int64_t period() const;

 private:
  void on_command(std::uint8_t reg, std::uint16_t value);

  std::int64_t powered_ = 0;       // us
  std::uint16_t frames_ = 0x001E;  // register 02, factory default
  std::uint8_t rate_ = 6;          // register 03: 10 Hz
  bool unlocked_ = false;
  std::vector<std::uint8_t> received_;
};

}  // namespace curbstone::simulate::devices
