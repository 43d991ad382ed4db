#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "common/time/clock_offset.hpp"

namespace curbstone::encoder {

/// Stamps samples that carry no time but are taken with a known period, from their times of arrival. These are late by
/// a varying delay. Several samples may arrive at once after a pause, and single ones may be missing.
///
/// The k-th sample was taken at offset + k * period. The offset is that of the least delayed sample (ClockOffset). k
/// is certain where a sample comes less than a period after its time. One that comes later may be late or follow a lost
/// one, and waits, and so do those that follow it. They are decided together
///  - by one that comes less than a period late if none is missing: then none is;
///  - by two of them whose counts tell the same number of missing samples (the caller's evidence). One does not
///    suffice: it may be corrupt;
///  - by kSettle of them in a row, most of which come right on the period: the host's delays have no such order. Those
///    before the second one that is on it are unsure.
/// A sample that comes well before its time is off the beat: sent twice, or the device keeps another period or phase
/// now. It and those that follow are unsure, until one is on the beat again, or kRegular in a row are a period apart:
/// then all begins anew. Another period is measured meanwhile.
///
/// Where kMost wait, the oldest is given up as unsure. If they keep a beat of their own, or none for long, all begins
/// anew. Pure; one thread. All times in us.
class PeriodClock {
 public:
  struct Stamp {
    std::int64_t utime = 0;    ///< us; never after the arrival
    int steps = 1;             ///< periods since the sample before; 0: off the beat
    int lost = 0;              ///< samples that never came since the sample before
    bool sure = true;          ///< false: nobody knows when it was taken; the stamp is a guess
    bool restarted = false;    ///< nothing is known of the time since the sample before
    std::int64_t earlier = 0;  ///< us by which this sample shows those before to have been taken earlier than stamped
  };
  /// How many periods, least..most, have passed since the last sample that was stamped; nothing where that cannot be
  /// decided.
  using Evidence = std::function<std::optional<int>(int least, int most)>;

  /// Samples in a row.
  static constexpr int kSettle = 50;
  /// Samples that wait.
  static constexpr int kMost = 200;
  /// Samples a period apart that are a beat.
  static constexpr int kRegular = 5;
  /// us; after a longer silence all begins anew, unless the evidence says that nothing is missing: the host slept, and
  /// what the device sent meanwhile comes in one go.
  static constexpr std::int64_t kMaxGap = 500'000;
  /// us; after a silence longer than this all begins anew in any case: no buffer is so deep.
  static constexpr std::int64_t kMaxSleep = 5'000'000;

  explicit PeriodClock(std::int64_t period) : nominal_(period), period_(period) {}

  /// Takes the arrival of the next sample. Returns the stamps of those, in order of arrival and oldest first, that are
  /// now decided; they are valid until the next call.
  const std::vector<Stamp>& stamp(std::int64_t received, const Evidence& evidence);
  void restart() { running_ = false; }
  /// From now on the device keeps this period, us: see FirstPeriod. Before the first sample.
  void set_period(std::int64_t period) { period_ = period; }
  /// A sample that arrives now comes well before the next one can have been taken.
  [[nodiscard]] bool is_early(std::int64_t received) const;

  /// us, in use: the nominal one, unless the device plainly keeps another.
  [[nodiscard]] std::int64_t period() const { return period_; }

 private:
  struct Waiting {
    std::int64_t received;
    std::int64_t delay;          // us, if none before it is missing
    std::optional<int> missing;  // before it, by the evidence
  };
  void begin(std::int64_t received);
  void measure_period(std::int64_t received);
  [[nodiscard]] std::int64_t tolerance() const;
  [[nodiscard]] int most_missing(std::int64_t delay) const;
  [[nodiscard]] bool is_punctual(std::int64_t delay) const;
  [[nodiscard]] int count_punctual(std::int64_t delay) const;
  [[nodiscard]] std::int64_t least_delay() const;
  [[nodiscard]] bool on_another_beat() const;
  void give_up_oldest();
  [[nodiscard]] bool comes_off_the_beat(std::int64_t received) const;
  void take_off_the_beat(std::int64_t received, std::int64_t gap);
  void decide_by_evidence();
  void decide_by_order();
  void decide(int missing, std::size_t first, std::size_t last, bool by_evidence = false);
  void stamp_next(std::int64_t received, int steps, bool sure, int lost);

  static constexpr int kBlock = 64;  // samples over which the period is measured

  std::int64_t nominal_;
  std::int64_t period_;
  ClockOffset offset_;
  bool running_ = false;
  std::int64_t index_ = 0;       // k of the last stamped sample
  std::int64_t last_stamp_ = 0;  // us
  std::int64_t last_received_ = 0;
  int stamped_ = 0;   // samples since the beginning, up to kSettle
  int given_up_ = 0;  // samples since one was stamped
  int off_beat_ = 0;  // samples since one was on the beat
  int regular_ = 0;   // of these, the last in a row that came a period apart
  std::deque<Waiting> waiting_;
  std::vector<Stamp> decided_;
  std::int64_t block_begin_ = 0;                 // us, arrival of the block's first sample
  std::int64_t block_last_ = 0;                  // us, likewise of the one before
  std::array<std::int64_t, kBlock - 1> gaps_{};  // us, between the block's samples
  int block_size_ = 0;
  std::int64_t last_mean_ = 0;  // us, period of the block before
  bool last_even_ = false;      // and whether its samples came evenly
};

}  // namespace curbstone::encoder
