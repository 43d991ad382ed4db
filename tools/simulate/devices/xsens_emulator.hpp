#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/imu/xsens/xbus_frame.hpp"

namespace curbstone::simulate::devices {

/// A measurement of the emulated sensor, in its own frame (x forward, y left, z up when mounted so).
struct XsensSample {
  std::array<double, 3> acceleration{};                ///< specific force, m/s^2 (+g upwards at rest)
  std::array<double, 3> angular_rate{};                ///< rad/s
  std::optional<std::array<double, 4>> orientation{};  ///< w x y z
  double temperature = 25.0;                           ///< deg C
  std::uint32_t clipping = 0;                          ///< bits 8..13 of the status word
};

/// An Xsens MTi seen from its serial line: boots, is configured, streams MTData2 in float32. A byte state machine
/// without a clock: the caller passes the time (us, any monotonic clock) and transfers the bytes. While measuring() it
/// expects sample() every `period()`; a frame takes `transmission_time()` on a real line, which a simulator may
/// respect.
class XsensEmulator {
 public:
  /// A configured device sends everything the driver needs from power-up; a new one sends only counter and time.
  struct Settings {
    bool configured = false;
    int rate = 100;                         ///< Hz, until configured otherwise
    std::uint32_t first_tick = 0;           ///< SampleTimeFine at power-up, 0.1 ms
    std::uint32_t tick_wrap = 864'000'000;  ///< ticks after which SampleTimeFine restarts; 0: after 2^32
    double clock_error = 0.0;               ///< of the device's oscillator: 30e-6 is 30 ppm fast
  };

  explicit XsensEmulator(const Settings& settings) : settings_(settings) {}
  XsensEmulator() : XsensEmulator(Settings{}) {}

  /// Switches the supply on, or off and on: sends WakeUp. Without a reply from the host within 0.5 s it starts to
  /// measure.
  std::vector<std::uint8_t> power_on(std::int64_t now);
  /// Takes bytes from the host; returns the responses.
  std::vector<std::uint8_t> on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes);
  /// One MTData2 message; empty while the device does not measure.
  std::vector<std::uint8_t> sample(std::int64_t now, const XsensSample& sample);

  [[nodiscard]] bool measuring(std::int64_t now) const;
  /// us between samples, as configured.
  [[nodiscard]] std::int64_t period() const { return 1'000'000 / rate_; }
  /// us to transmit `size` bytes on a line of `baud`, 8N1.
  [[nodiscard]] static std::int64_t transmission_time(std::size_t size, int baud) {
    return static_cast<std::int64_t>(size) * 10'000'000 / baud;
  }

 private:
  enum class State { kOff, kBooting, kConfig, kMeasurement };
  struct Output {
    std::uint16_t id;
    std::uint16_t rate;
  };

  void on_frame(const imu::xsens::XbusFrame& frame, std::int64_t now, std::vector<std::uint8_t>& answer);
  std::vector<std::uint8_t> configure(std::span<const std::uint8_t> list);
  void append_item(std::vector<std::uint8_t>& payload, std::uint16_t id, std::int64_t now, const XsensSample& sample);
  void use_default_outputs();

  Settings settings_;
  State state_ = State::kOff;
  std::int64_t powered_ = 0;  // us
  std::uint16_t counter_ = 0;
  int rate_ = 100;
  std::vector<Output> outputs_;
  imu::xsens::XbusParser parser_;
};

}  // namespace curbstone::simulate::devices
