#pragma once

#include <cstdint>
#include <optional>

namespace curbstone {

/// Paces the items of a recording so that they are spaced as they were recorded. A step of the recorded times that is
/// longer than kMaxStep, or that leads back, is a damaged time, a clock that was set, or a pause, and is skipped
/// without waiting. All times in us.
class ReplayPace {
 public:
  static constexpr std::int64_t kMaxStep = 10'000'000;

  /// `rate` times as fast as recorded; 0: without pacing.
  explicit ReplayPace(double rate) : rate_(rate) {}

  /// Whether the next item, recorded at `recorded`, is due at `now` on a steady clock. The first one is due at once.
  [[nodiscard]] bool due(std::int64_t recorded, std::int64_t now) {
    if (!began_) began_ = now;
    if (asked_ != recorded) {
      const std::int64_t step = recorded - asked_.value_or(recorded);
      if (step > 0 && step <= kMaxStep) at_ += step;
      asked_ = recorded;
    }
    return rate_ <= 0 || static_cast<double>(at_) <= static_cast<double>(now - *began_) * rate_;
  }

 private:
  double rate_;
  std::optional<std::int64_t> began_;
  std::optional<std::int64_t> asked_;  // recorded time of the last item asked for
  std::int64_t at_ = 0;                // recorded time since the first item, without the skipped steps
};

}  // namespace curbstone
