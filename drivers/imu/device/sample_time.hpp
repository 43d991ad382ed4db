#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace curbstone::imu::device {

/// Unwraps SampleTimeFine of the samples, and judges each: a wrong one must cost no more than its sample, for the
/// device's clock hangs on it (ClockOffset). Messages without inertial data do not belong here: those of the device's
/// GNSS receiver bear the time of the fix, up to seconds old.
///
/// A time is believed if it continues the last one that was. If not, the sample is refused. If the next continues the
/// refused one, and not the believed one, the device has restarted, or has only shifted its samples. "Continues" means:
/// later, by a whole number of sample intervals, give or take what is usual for this device, that the packet counter
/// allows, or, without a counter, that the time of receipt allows. After a second without a sample it is enough that
/// the time of receipt agrees.
///
/// SampleTimeFine begins again at zero after 2^32 ticks on some devices (MTi-1, 600 series) and after a day (864e6
/// ticks) on others (10 and 100 series). The messages do not tell which, so a step may be either. Pure; one thread.
class SampleTime {
 public:
  static constexpr std::int64_t kTick = 100;         ///< us
  static constexpr std::int64_t kSlack = 500'000;    ///< us by which samples may wait for their receipt, in a bunch
  static constexpr std::int64_t kPause = 1'000'000;  ///< us of receipt without a believed sample

  enum class Verdict {
    kContinues,  ///< the sample's time is right
    kRestarted,  ///< so it is, but it has nothing to do with the times before
    kRepeated,   ///< the time of the sample before: the same message again
    kLate,       ///< of a sample that should have come before the last one
    kRefused,    ///< wrong, or the first of a device that restarted
  };
  struct Result {
    Verdict verdict = Verdict::kRefused;
    std::int64_t time = 0;  ///< us on the device's clock, unwrapped
    int missing = 0;        ///< samples between the last believed one and this, of those that are seen by their time
  };

  /// `received` us. `ahead`: messages from the last believed sample to this one, by the packet counter, and `others`:
  /// of these, those that are known to be no samples. Negative: it comes late by that many.
  Result next(std::uint32_t ticks, std::int64_t received, std::optional<int> ahead, int others = 0);
  /// The mean interval of the last samples, us; 0 while it is not known.
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

  int others_ = 0;  // of this sample
  std::optional<Seen> believed_;
  std::optional<Seen> refused_;  // since the last believed one
  int refusals_ = 0;             // since then
  std::optional<std::uint32_t> last_;
  std::array<std::int64_t, 32> steps_{};  // ticks, of the last samples, believed or not
  std::size_t learned_ = 0;
  std::int64_t interval_ = 0;   // ticks between samples; 0: not known yet
  std::int64_t tolerance_ = 0;  // ticks, of a step that is a multiple of the interval
};

}  // namespace curbstone::imu::device
