#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "common/time/clock_drift.hpp"

namespace curbstone {

/// Converts a device's stamps to the host's clock. A device stamp has no jitter, but an unknown offset and some drift.
/// The receipt time is on the host's clock, but late by a delay that varies and is never negative. Therefore the
/// smallest (receipt - stamp) of the last `window` us belongs to the least delayed sample, and is the offset.
///
/// Drift: a crystal that is slow by 50 ppm is followed within 50 ppm * window (0.25 ms), a fast one at once. What
/// drifts more than a crystal is measured (ClockDrift, 5 s), and the offset goes on by it. During the first samples the
/// offset may still fall; results may then step back by the delay of those samples. The result is a function of the
/// inputs alone. All times in us.
class ClockOffset {
 public:
  explicit ClockOffset(std::int64_t window = 5'000'000, std::int64_t jump = 1'000'000)
      : half_window_(window / 2), jump_(jump) {}

  /// `stamp` of the sample on the device's clock (unwrapped), `received` when it arrived, on the host's. Returns the
  /// stamp on the host's clock, which is never after `received`.
  std::int64_t to_host(std::int64_t stamp, std::int64_t received) {
    const std::int64_t offset = received - stamp;
    if (const bool stepped = current_.known() && std::abs(offset - offset_at(stamp)) > jump_; stepped) {
      ++jumps_;
      current_ = previous_ = {};
      drift_ = {};
    }
    drift_.add(stamp, offset);
    if (!current_.known()) {
      since_ = stamp;
    } else if (stamp - since_ >= half_window_) {
      previous_ = stamp - since_ < 2 * half_window_ ? current_ : Smallest{};
      current_ = {};
      since_ = stamp;
    }
    if (!current_.known() || offset < at(current_, stamp)) current_ = {stamp, offset};
    latest_ = stamp;
    return stamp + this->offset();
  }

  /// How often the device's clock stepped by more than `jump` us. After each step the offset is estimated anew.
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }

  /// What is added to the device's stamps, us, at the latest of them. Before the first sample: the largest int64.
  [[nodiscard]] std::int64_t offset() const { return offset_at(latest_); }

  /// How far the device's clock drifts.
  [[nodiscard]] const ClockDrift& drift() const { return drift_; }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

  struct Smallest {  // of a half of the window
    std::int64_t stamp = 0;
    std::int64_t offset = kNone;
    [[nodiscard]] bool known() const { return offset != kNone; }
  };
  /// The smallest offset as it would be at another time. That of a clock that gains is left: it is followed at once,
  /// and the end of a drift that is foreseen makes stamps early, while those of one that loses end at their receipt.
  [[nodiscard]] std::int64_t at(const Smallest& smallest, std::int64_t stamp) const {
    if (!smallest.known() || drift_.drift() <= 0) return smallest.offset;
    return smallest.offset + std::llround(drift_.drift() * static_cast<double>(stamp - smallest.stamp));
  }
  [[nodiscard]] std::int64_t offset_at(std::int64_t stamp) const {
    return std::min(at(current_, stamp), at(previous_, stamp));
  }

  std::int64_t half_window_;
  std::int64_t jump_;
  std::int64_t since_ = 0;   ///< device time at which the current half of the window began
  std::int64_t latest_ = 0;  ///< stamp
  Smallest current_, previous_;
  ClockDrift drift_;
  std::int64_t jumps_ = 0;
};

}  // namespace curbstone
