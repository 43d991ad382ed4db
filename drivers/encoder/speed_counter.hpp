#pragma once

#include <array>
#include <optional>

#include "common/bus/counters.hpp"
#include "drivers/encoder/wheel_counter.hpp"

namespace curbstone::encoder {

/// Integrates measured wheel speeds to angles by the trapezoidal rule, for a bus that reports speeds and no counts. The
/// angles drift with the error of the speeds. Positive is forward for both wheels; index 0 is the left wheel. Pure; one
/// thread.
///
/// Counts: refused.jump (faster than the wheels can turn).
class SpeedCounter {
 public:
  explicit SpeedCounter(const WheelCounter::Settings& settings) : settings_(settings) {}

  /// `speeds` rad/s, as on the bus; `elapsed` s since the last update() call. Empty if the speeds are impossible.
  std::optional<WheelCounter::Sample> update(const std::array<double, 2>& speeds, double elapsed);
  /// `elapsed` s have passed since the last update() or pass() call without known speeds.
  void skip(double elapsed) { since_accepted_ += elapsed; }
  /// The motion until the next sample is unknown.
  void restart() { last_.reset(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  WheelCounter::Settings settings_;
  std::optional<std::array<double, 2>> last_;  // rad/s, forward
  double since_accepted_ = 0;                  // s
  std::array<double, 2> angle_{};
  Counters counters_;
};

}  // namespace curbstone::encoder
