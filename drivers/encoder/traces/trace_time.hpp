#pragma once

#include <cstdint>
#include <optional>

namespace curbstone::encoder::traces {

/// Judges the times of a recording's frames: they grow, by no more than kPause at a time. One that leads back, or far
/// ahead, is damaged. Where kAgreeing in a row grow from each other, the recording goes on there: a pause, a clock that
/// was set, or another recording behind the first. Pure; times in us.
class TraceTime {
 public:
  static constexpr std::int64_t kPause = 10'000'000;
  static constexpr int kAgreeing = 10;

  /// Whether the next frame's time can be.
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
  /// How often the recording went on elsewhere.
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }

 private:
  [[nodiscard]] static bool grows(std::int64_t from, std::int64_t to) { return to >= from && to - from <= kPause; }

  std::optional<std::int64_t> last_;
  std::int64_t other_ = 0;  // the last that could not be
  int agreeing_ = 0;        // of these, in a row
  std::int64_t jumps_ = 0;
};

}  // namespace curbstone::encoder::traces
