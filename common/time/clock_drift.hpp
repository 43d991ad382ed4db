#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

namespace curbstone {

/// Measures by how much a device's clock is slower than the host's, from (receipt - stamp) of its samples: the smallest
/// one of each kSlot belongs to a sample that was hardly delayed. A drift counts when both halves of kSlots show it,
/// and when it is more than a crystal's: the delays of a loaded host change, too, but not evenly. Pure; one thread. All
/// times in us.
class ClockDrift {
 public:
  static constexpr std::int64_t kSlot = 1'000'000;  ///< us
  static constexpr std::size_t kSlots = 5;
  static constexpr double kLeast = 100e-6;
  static constexpr double kFault = 500e-6;  ///< NTP does not slew a clock by more for long

  /// A sample on the device's clock, and its (receipt - stamp).
  void add(std::int64_t stamp, std::int64_t offset) {
    if (count_ == 0 && low_.offset == kNone) began_ = stamp;
    if (stamp - began_ >= 2 * kSlot || stamp < began_ - kSlot) {
      *this = {};  // a silence
      began_ = stamp;
    } else if (stamp - began_ >= kSlot) {
      end_slot();
      began_ = stamp;
    }
    const Low low{stamp, offset};
    if (low_.offset == kNone || at(low, stamp) < at(low_, stamp)) low_ = low;
  }
  /// us by which the device loses in a us; 0: not more than a crystal; negative: it gains.
  [[nodiscard]] double drift() const { return drift_; }
  /// A fault in words while the drift is too large.
  [[nodiscard]] std::optional<std::string> fault() const {
    if (std::abs(drift_) < kFault) return std::nullopt;
    return std::string("the device's clock ") + (drift_ > 0 ? "loses " : "gains ") +
           std::to_string(std::llround(std::abs(drift_) * 1e6)) +
           " us each second against the host's: is its source of time right (GPS, PTP), or is the host's clock being "
           "set?";
  }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  struct Low {
    std::int64_t stamp = 0;
    std::int64_t offset = kNone;
  };

  /// The offset of a sample at another time.
  [[nodiscard]] double at(const Low& low, std::int64_t stamp) const {
    return static_cast<double>(low.offset) + drift_ * static_cast<double>(stamp - low.stamp);
  }
  static double slope(const Low& from, const Low& to) {
    return static_cast<double>(to.offset - from.offset) / static_cast<double>(to.stamp - from.stamp);
  }
  void end_slot() {
    std::shift_left(lows_.begin(), lows_.end(), 1);
    lows_.back() = low_;
    low_ = {};
    if (++count_ < kSlots) return;
    constexpr std::size_t kMiddle = kSlots / 2;
    const double first = slope(lows_.front(), lows_[kMiddle]), second = slope(lows_[kMiddle], lows_.back());
    const double whole = slope(lows_.front(), lows_.back());
    if (std::abs(whole) < kLeast / 2) {
      drift_ = 0;
    } else if (std::abs(whole) >= kLeast && std::abs(first - second) <= std::abs(whole) / 4) {
      drift_ = whole;
    }
  }

  std::array<Low, kSlots> lows_;
  std::size_t count_ = 0;  // of the ended slots
  std::int64_t began_ = 0;
  Low low_;
  double drift_ = 0;
};

}  // namespace curbstone
