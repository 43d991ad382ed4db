#pragma once

#include <cstdint>
#include <optional>

namespace curbstone::encoder::traces {

/// Checks the times of a recording's frames: they increase, by no more than kPause at a time. A time that goes back or
/// leaps far ahead is damaged. Where kAgreeing in a row increase from each other, the recording continues there: after
/// a pause, a step of the clock, or the end of the first of two joined recordings. Pure; times in us.
class TraceTime {
 public:
  static constexpr std::int64_t kPause = 10'000'000;
  static constexpr int kAgreeing = 10;

  /// Whether the next frame's time is plausible.
  [[nodiscard]] bool take(std::int64_t utime) {
    if (!last_ || grows(*last_, utime)) {
      last_ = utime;
      agreeing_ = 0;
      return true;
    }
    agreeing_ = agreeing_ > 0 && grows(other_, utime) ? agreeing_ + 1 : 1;
    other_ = utime;
    if (agreeing_ < kAgreeing) return false;
    ++jumps_;
    last_ = utime;
    agreeing_ = 0;
    return true;
  }
  /// Number of times that the recording continued elsewhere.
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }

 private:
  [[nodiscard]] static bool grows(std::int64_t from, std::int64_t to) { return to >= from && to - from <= kPause; }

  std::optional<std::int64_t> last_;
  std::int64_t other_ = 0;  // the latest implausible one
  int agreeing_ = 0;        // of these, in a row
  std::int64_t jumps_ = 0;
};

}  // namespace curbstone::encoder::traces
