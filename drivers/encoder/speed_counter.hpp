#pragma once

#include <array>
#include <optional>

#include "common/bus/counters.hpp"
#include "drivers/encoder/lone_leap.hpp"
#include "drivers/encoder/wheel_counter.hpp"

namespace curbstone::encoder {

/// Integrates measured wheel speeds to angles by the trapezoidal rule, for a bus that reports speeds and no counts. The
/// angles drift with the error of the speeds. Positive is forward for both wheels; index 0 is the left wheel. Pure; one
/// thread.
///
/// Counts: refused.jump (faster than the wheels can turn), refused.outlier (a speed that leaps away from those before
/// it, and that the next one does not confirm), ignored.first (the first one, which none confirms).
class SpeedCounter {
 public:
  /// `resolution`: rad/s, the least difference of two speeds.
  SpeedCounter(const WheelCounter::Settings& settings, double resolution)
      : settings_(settings), resolution_(resolution) {}

  /// `speeds` rad/s, as on the bus; `elapsed` s since the last update() call. Empty if the speeds are impossible.
  std::optional<WheelCounter::Sample> update(const std::array<double, 2>& speeds, double elapsed);
  /// `elapsed` s have passed since the last update() or pass() call without known speeds.
  void skip(double elapsed) { since_accepted_ += elapsed; }
  /// The motion until the next sample is unknown.
  void restart() {
    last_.reset();
    leap_.restart();
    is_confirmed_ = false;
    unconfirmed_ = 0;
  }
  /// Name of the counter for the last update() that returned nothing.
  [[nodiscard]] const char* refusal() const { return refusal_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  [[nodiscard]] const char* cause_to_refuse(const std::array<double, 2>& forward);

  WheelCounter::Settings settings_;
  double resolution_;
  std::optional<std::array<double, 2>> last_;  // rad/s, forward
  double since_accepted_ = 0;                  // s
  LoneLeap leap_;
  bool is_confirmed_ = false;  // two speeds since the start were alike
  int unconfirmed_ = 0;
  std::array<double, 2> angle_{};
  const char* refusal_ = "refused.jump";
  Counters counters_;
};

}  // namespace curbstone::encoder
