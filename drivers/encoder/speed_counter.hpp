#pragma once

#include <array>
#include <optional>

#include "common/bus/counters.hpp"
#include "drivers/encoder/wheel_counter.hpp"

namespace curbstone::encoder {

/// Turns measured wheel speeds into angles, where a bus tells speeds and no counts: the integral, by trapezoids. It
/// drifts with the error of the speeds. Positive forward for either wheel; index 0 is the left wheel. Pure; one thread.
///
/// Counts: refused.jump (faster than the wheels can turn).
class SpeedCounter {
 public:
  explicit SpeedCounter(const WheelCounter::Settings& settings) : settings_(settings) {}

  /// `speeds` rad/s, as the bus has them; `elapsed` s since the last update() call. Empty if the speeds cannot be.
  std::optional<WheelCounter::Sample> update(const std::array<double, 2>& speeds, double elapsed);
  /// `elapsed` s passed since the last update() or pass() call, and nothing is known of the speeds.
  void pass(double elapsed) { since_accepted_ += elapsed; }
  /// What the wheels turn until the next sample is not known.
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
