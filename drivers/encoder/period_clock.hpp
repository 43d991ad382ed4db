#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/time/clock_offset.hpp"

namespace curbstone::encoder {

/// Stamps samples that carry no time but are taken with a known period, from their times of arrival. These are late by
/// a varying delay. Several samples may arrive at once after a pause, and single ones may be missing.
///
/// The k-th sample was taken at offset + k * period. The offset is that of the least delayed sample (ClockOffset). k
/// must be estimated: after a pause, samples may be lost or only late. The caller's evidence decides: wheels do not
/// double their speed from one sample to the next. Without evidence they count as late, and the number that may be lost
/// is kept. If no sample makes the lateness good within kSettle, the stamps follow it. That is no proof of a loss: a
/// busy host can be late for half a second. If none does within kConfirm, the samples were lost. Lateness that the
/// evidence explains, or that came without a pause, is the host's, however long it lasts. Pure; one thread. All times
/// in us.
class PeriodClock {
 public:
  struct Stamp {
    std::int64_t utime = 0;    ///< us; never after the arrival
    int steps = 1;             ///< periods since the sample before, by the evidence: steps - 1 were lost
    int lost_before = 0;       ///< samples now known, in hindsight, to have been lost
    bool restarted = false;    ///< nothing is known of the time since the sample before
    std::int64_t earlier = 0;  ///< us by which this sample shows those before to have been taken earlier than stamped
  };
  /// Given the most periods that may have passed, how many have; nothing where that cannot be told.
  using Evidence = std::function<std::optional<int>(int max_steps)>;

  /// Samples after which the stamps follow lateness that nobody made good.
  static constexpr int kSettle = 50;
  /// us after which it was a loss.
  static constexpr std::int64_t kConfirm = 3'000'000;
  /// us; after a longer silence all begins anew, unless the evidence says that nothing is missing: the host slept, and
  /// what the device sent meanwhile comes in one go.
  static constexpr std::int64_t kMaxGap = 500'000;
  /// us; after a silence longer than this all begins anew in any case: no buffer is so deep.
  static constexpr std::int64_t kMaxSleep = 5'000'000;

  explicit PeriodClock(std::int64_t period) : nominal_(period), period_(period) {}

  Stamp stamp(std::int64_t received, const Evidence& evidence);
  void restart() { running_ = false; }

  /// us, in use: the nominal one, unless the device plainly keeps another.
  [[nodiscard]] std::int64_t period() const { return period_; }

 private:
  void begin(std::int64_t received);
  void measure_period(std::int64_t received);
  void acquit(std::int64_t early);
  [[nodiscard]] int confirm(std::int64_t received);

  static constexpr int kBlock = 64;  // samples over which the period is measured

  std::int64_t nominal_;
  std::int64_t period_;
  ClockOffset offset_;
  bool running_ = false;
  std::int64_t index_ = 0;       // k
  std::int64_t last_stamp_ = 0;  // us
  std::int64_t last_received_ = 0;
  std::int64_t least_delay_ = 0;  // us, of the last `settling_` samples
  int settling_ = 0;
  std::int64_t untold_ = 0;        // samples that, for all we know, were lost since the last punctual one
  int suspected_ = 0;              // samples, perhaps lost
  std::int64_t suspected_at_ = 0;  // us, arrival
  std::int64_t block_begin_ = 0;   // us, arrival of the block's first sample
  int block_size_ = 0;
  std::int64_t last_mean_ = 0;  // us, period of the block before
};

}  // namespace curbstone::encoder
