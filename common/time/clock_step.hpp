#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace curbstone {

/// Detects that the host's clock was set. It compares the wall clock, which stamps the measurements, with the steady
/// clock: their difference changes slowly while the clock is slewed, and at once when the clock is set or the host has
/// slept. Pure; all times in us. Call read() once a second or more often.
class ClockStep {
 public:
  static constexpr std::int64_t kMinStep = 50'000;         ///< us between two readings; less is no step
  static constexpr std::int64_t kRemembered = 60'000'000;  ///< us for which a step is reported

  /// The wall clock, and the steady clock before and after it was read: the process may have had to wait in between. A
  /// reading that took longer than kWorst is discarded.
  void read(std::int64_t steady_before, std::int64_t wall, std::int64_t steady_after) {
    if (steady_after - steady_before > kWorst) return;
    const std::int64_t difference = wall - steady_after;
    if (difference_ && std::abs(difference - *difference_) > kMinStep) {
      ++steps_;
      step_ = difference - *difference_;
      stepped_ = steady_after;
    }
    difference_ = difference;
    now_ = steady_after;
  }

  /// The size of the last step, if it was less than kRemembered before the last reading. Positive: forward.
  [[nodiscard]] std::optional<std::int64_t> recent() const {
    if (steps_ == 0 || now_ - stepped_ >= kRemembered) return std::nullopt;
    return step_;
  }
  [[nodiscard]] std::int64_t steps() const { return steps_; }

 private:
  static constexpr std::int64_t kWorst = 10'000;
  std::optional<std::int64_t> difference_;  // wall minus steady clock
  std::int64_t steps_ = 0;
  std::int64_t step_ = 0;     // the last step
  std::int64_t stepped_ = 0;  // its time by the steady clock
  std::int64_t now_ = 0;      // time of the last reading
};

}  // namespace curbstone
