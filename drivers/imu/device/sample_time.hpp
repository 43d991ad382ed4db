#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace curbstone::imu::device {

/// Unwraps SampleTimeFine of the samples, and checks each time: the device's clock depends on it (ClockOffset), so a
/// wrong time must cost no more than its sample. Do not pass messages without inertial data: those of the device's GNSS
/// receiver have the time of the fix, up to seconds old.
///
/// A time is accepted if it continues the last accepted one. Otherwise the sample is refused. If the next time
/// continues the refused one and not the accepted one, the device has restarted, or has only shifted its samples.
/// "Continues" means: later, by a whole number of sample intervals within the usual tolerance of this device, and
/// consistent with the packet counter or, without a counter, with the time of receipt. After a second without a sample,
/// consistency with the time of receipt is sufficient.
///
/// SampleTimeFine wraps to zero after 2^32 ticks on some devices (MTi-1, 600 series) and after a day (864e6 ticks) on
/// others (10 and 100 series). The messages do not tell which, so both are accepted. Pure; one thread.
class SampleTime {
 public:
  static constexpr std::int64_t kTick = 100;         ///< us
  static constexpr std::int64_t kSlack = 500'000;    ///< us by which the receipt of samples in a bunch may be delayed
  static constexpr std::int64_t kPause = 1'000'000;  ///< us of receipt without an accepted sample

  enum class Verdict {
    kContinues,  ///< the time is right
    kRestarted,  ///< the time is right, but unrelated to the times before
    kRepeated,   ///< the time of the previous sample: the same message again
    kLate,       ///< a sample that should have come before the latest one
    kRefused,    ///< wrong, or the first of a device that restarted
  };
  struct Result {
    Verdict verdict = Verdict::kRefused;
    std::int64_t time = 0;  ///< us on the device's clock, unwrapped
    int missing = 0;        ///< samples missing since the latest accepted one, as far as their times show it
  };

  /// `received` us. `ahead`: number of messages from the latest accepted sample to this one, by the packet counter;
  /// negative: it is late by that many. `others`: of these, messages that are known not to be samples.
  Result next(std::uint32_t ticks, std::int64_t received, std::optional<int> ahead, int others = 0);
  /// Mean interval of the latest samples, us; 0 if unknown.
  [[nodiscard]] double interval() const;

 private:
  struct Seen {
    std::uint32_t ticks;
    std::int64_t unwrapped;  // ticks
    std::int64_t received;   // us
  };

  enum class Strictness { kOnGrid, kInOrder };
  [[nodiscard]] std::optional<std::int64_t> step(const Seen& from, const Seen& to, std::optional<int> ahead,
                                                 Strictness strictness) const;
  [[nodiscard]] bool in_order(std::int64_t step, std::int64_t elapsed, std::optional<int> ahead) const;
  [[nodiscard]] bool on_grid(std::int64_t step) const { return off_grid(step) <= tolerance_ + intervals(step) / 2; }
  [[nodiscard]] std::int64_t off_grid(std::int64_t step) const;
  [[nodiscard]] std::int64_t intervals(std::int64_t step) const;
  void learn(std::int64_t step);

  int others_ = 0;  // for the current sample
  std::optional<Seen> believed_;
  std::optional<Seen> refused_;  // since the latest accepted one
  int refusals_ = 0;             // since then
  std::optional<std::uint32_t> last_;
  std::array<std::int64_t, 32> steps_{};  // ticks, of the latest samples, accepted or not
  std::size_t learned_ = 0;
  std::int64_t interval_ = 0;   // ticks between samples; 0: not known yet
  std::int64_t tolerance_ = 0;  // ticks, for a step that is a multiple of the interval
};

}  // namespace curbstone::imu::device
