#pragma once

#include <cstdint>
#include <optional>

namespace curbstone::imu {

/// Unwraps SampleTimeFine. It begins again at zero after 2^32 ticks on some devices (MTi-1, 600 series) and after a day
/// (864e6 ticks) on others (10 and 100 series). The messages do not tell which. So a step back by either period, give
/// or take kMaxGap, is a wrap. Any other step back is a restart of the device.
class SampleTime {
 public:
  static constexpr std::int64_t kTick = 100;        ///< us
  static constexpr std::int64_t kMaxGap = 600'000;  ///< ticks, a minute without data

  static constexpr std::int64_t kMaxStepBack = 10'000;  ///< ticks, a second: a message that was sent late

  struct Result {
    std::int64_t time = 0;   ///< us on the device's clock, unwrapped
    bool restarted = false;  ///< `time` has nothing to do with the times before
  };

  Result unwrap(std::uint32_t ticks) {
    constexpr std::int64_t kDay = 864'000'000;
    constexpr std::int64_t kFull = std::int64_t{1} << 32;
    const std::int64_t step = last_ ? std::int64_t{ticks} - *last_ : 0;
    bool restarted = false;
    if (step < -kMaxStepBack) {
      if (*last_ < kDay && step + kDay <= kMaxGap) {
        base_ += kDay;
      } else if (step + kFull <= kMaxGap) {
        base_ += kFull;
      } else {
        base_ = 0;
        restarted = true;
      }
    }
    if (step < -kMaxStepBack || step >= 0) last_ = ticks;
    return {(base_ + ticks) * kTick, restarted};
  }

 private:
  std::optional<std::uint32_t> last_;
  std::int64_t base_ = 0;  // ticks
};

/// Finds losses by the 16-bit packet counter.
class PacketCounter {
 public:
  /// How many messages were lost between the one before and this one.
  int lost_before(std::uint16_t counter) {
    const int lost = last_ ? static_cast<std::uint16_t>(counter - *last_ - 1) : 0;
    last_ = counter;
    return lost;
  }
  /// The device counts anew: whatever comes next is the next one.
  void restart() { last_.reset(); }

 private:
  std::optional<std::uint16_t> last_;
};

}  // namespace curbstone::imu
