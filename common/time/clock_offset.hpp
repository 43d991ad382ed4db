#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>

namespace curbstone {

/// Converts a device's stamps to the host's clock. A device stamp has no jitter, but an unknown offset and some drift.
/// The receipt time is on the host's clock, but late by a delay that varies and is never negative. Therefore the
/// smallest (receipt - stamp) of the last `window` us belongs to the least delayed sample, and is the offset.
///
/// Drift: an oscillator that is slow by 50 ppm is followed within 50 ppm * window (0.25 ms), a fast one at once. During
/// the first samples the offset may still fall; results may then step back by the delay of those samples. The result is
/// a function of the inputs alone. All times in us.
class ClockOffset {
 public:
  explicit ClockOffset(std::int64_t window = 5'000'000, std::int64_t jump = 1'000'000)
      : half_window_(window / 2), jump_(jump) {}

  /// `stamp` of the sample on the device's clock (unwrapped), `received` when it arrived, on the host's. Returns the
  /// stamp on the host's clock, which is never after `received`.
  std::int64_t to_host(std::int64_t stamp, std::int64_t received) {
    const std::int64_t offset = received - stamp;
    if (const bool stepped = current_ != kNone && std::abs(offset - this->offset()) > jump_; stepped) {
      ++jumps_;
      current_ = previous_ = kNone;
    }
    if (current_ == kNone) {
      since_ = stamp;
    } else if (stamp - since_ >= half_window_) {
      previous_ = stamp - since_ < 2 * half_window_ ? current_ : kNone;
      current_ = kNone;
      since_ = stamp;
    }
    current_ = std::min(current_, offset);
    return stamp + this->offset();
  }

  /// How often the device's clock stepped by more than `jump` us. After each step the offset is estimated anew.
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }

  /// What is added to the device's stamps, us. Before the first sample: the largest int64.
  [[nodiscard]] std::int64_t offset() const { return std::min(current_, previous_); }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

  std::int64_t half_window_;
  std::int64_t jump_;
  std::int64_t since_ = 0;        ///< device time at which the current half of the window began
  std::int64_t current_ = kNone;  ///< smallest offset of the current half
  std::int64_t previous_ = kNone;
  std::int64_t jumps_ = 0;
};

}  // namespace curbstone
