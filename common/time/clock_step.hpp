#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace curbstone {

/// Whether the host's clock was set. The wall clock, by which measurements are stamped, is compared with the steady
/// one: the difference of the two changes slowly while the clock is slewed, and at once when it is set (or when the
/// host slept). Pure; all times in us. To be fed once a second or
/// more often.
class ClockStep {
 public:
  static constexpr std::int64_t kLeast = 50'000;           ///< us between two readings; less is no step
  static constexpr std::int64_t kRemembered = 60'000'000;  ///< us that a step is reported

  /// The wall clock, and the steady one before and after it was read: in between the process may have had to wait. A
  /// reading that took longer than kWorst is not used.
  void read(std::int64_t steady_before, std::int64_t wall, std::int64_t steady_after) {
    if (steady_after - steady_before > kWorst) return;
    const std::int64_t difference = wall - steady_after;
    if (difference_ && std::abs(difference - *difference_) > kLeast) {
      ++steps_;
      step_ = difference - *difference_;
      stepped_ = steady_after;
    }
    difference_ = difference;
    now_ = steady_after;
  }

  /// By how much the clock was set last, if that was less than kRemembered before the last reading. Positive: forward.
  [[nodiscard]] std::optional<std::int64_t> recent() const {
    if (steps_ == 0 || now_ - stepped_ >= kRemembered) return std::nullopt;
    return step_;
  }
  [[nodiscard]] std::int64_t steps() const { return steps_; }

 private:
  static constexpr std::int64_t kWorst = 10'000;
  std::optional<std::int64_t> difference_;  // wall minus steady clock
  std::int64_t steps_ = 0;
  std::int64_t step_ = 0;     // the last one
  std::int64_t stepped_ = 0;  // when, by the steady clock
  std::int64_t now_ = 0;      // of the last reading
};

}  // namespace curbstone
