#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "common/time/clock_offset.hpp"

namespace curbstone::encoder {

/// Stamps samples that carry no time but are taken with a known period, from their times of arrival. Arrivals are late
/// by a varying delay; several samples may arrive at once after a pause, and single ones may be missing.
///
/// The k-th sample was taken at offset + k * period. The offset is that of the least delayed sample (ClockOffset). k is
/// certain if a sample arrives less than a period after its time. A sample that arrives later may be late, or follow a
/// lost one; it waits, and so do those that follow it. They are decided together
///  - by a sample that is less than a period late if none is missing: then none is missing;
///  - by two of them whose counts show the same number of missing samples (the caller's evidence). One does not
///    suffice: it may be corrupt;
///  - by kSettle of them in a row, most of which arrive exactly on the period: the host's delays are not that regular.
///    Those before the second one on the period are unsure.
/// A sample that arrives well before its time is off phase: it was sent twice, or the device has changed its period
/// or phase. It and those that follow are unsure until one is in phase again, or kRegular in a row are a period
/// apart: then the clock restarts. A new period is measured meanwhile.
///
/// If kMaxWaiting samples wait, the oldest is released as unsure. If they keep a phase of their own, or none for long,
/// the clock restarts. Pure; one thread. All times in us.
class PeriodClock {
 public:
  struct Stamp {
    std::int64_t utime = 0;    ///< us; never after the arrival
    int steps = 1;             ///< periods since the previous sample; 0: off phase
    int lost = 0;              ///< lost samples since the previous sample
    bool sure = true;          ///< false: the time of sampling is unknown; the stamp is a guess
    bool restarted = false;    ///< the time since the previous sample is unknown
    std::int64_t earlier = 0;  ///< us by which this sample shows that those before were taken earlier than stamped
  };
  /// Number of periods, least..most, since the latest stamped sample; nothing if that cannot be decided.
  using Evidence = std::function<std::optional<int>(int least, int most)>;

  /// Samples in a row that decide by their regularity.
  static constexpr int kSettle = 50;
  /// Maximum number of waiting samples.
  static constexpr int kMaxWaiting = 200;
  /// Samples a period apart that make a new phase.
  static constexpr int kRegular = 5;
  /// us; after a longer silence the clock restarts, unless the evidence says that nothing is missing: the host was
  /// suspended, and what the device sent meanwhile arrives at once.
  static constexpr std::int64_t kMaxGap = 500'000;
  /// us; after a longer silence the clock restarts in any case: no buffer is that deep.
  static constexpr std::int64_t kMaxSleep = 5'000'000;

  explicit PeriodClock(std::int64_t period) : nominal_(period), period_(period) {}

  /// Takes the arrival of the next sample. Returns the stamps of the samples that are now decided, in order of arrival;
  /// they are valid until the next call.
  const std::vector<Stamp>& stamp(std::int64_t received, const Evidence& evidence);
  void restart() { running_ = false; }
  /// Sets the device's period, us, before the first sample: see FirstPeriod.
  void set_period(std::int64_t period) { period_ = period; }
  /// Whether a sample that arrives now is well before the earliest possible time of the next one.
  [[nodiscard]] bool is_early(std::int64_t received) const;

  /// us, the period in use: the nominal one, unless the device clearly has another.
  [[nodiscard]] std::int64_t period() const { return period_; }

 private:
  struct Waiting {
    std::int64_t received;
    std::int64_t delay;          // us, if no sample before it is missing
    std::optional<int> missing;  // samples before it, by the evidence
  };
  void begin(std::int64_t received);
  void measure_period(std::int64_t received);
  [[nodiscard]] std::int64_t tolerance() const;
  [[nodiscard]] int most_missing(std::int64_t delay) const;
  [[nodiscard]] bool is_punctual(std::int64_t delay) const;
  [[nodiscard]] int count_punctual(std::int64_t delay) const;
  [[nodiscard]] std::int64_t min_delay() const;
  [[nodiscard]] bool has_other_phase() const;
  void release_oldest();
  [[nodiscard]] bool is_off_phase(std::int64_t received) const;
  void add_off_phase(std::int64_t received, std::int64_t gap);
  void decide_by_evidence();
  void decide_by_regularity();
  /// How the number of missing samples was found.
  enum class Basis {
    kArrivals,  ///< times of arrival
    kEvidence,  ///< two later samples agree on it by their counts
  };
  struct Decision {
    int missing;                ///< samples that are missing before `first_certain`, and no more before `last`
    std::size_t first_certain;  ///< waiting sample from which on that number is certain
    std::size_t last;           ///< last waiting sample to stamp
    Basis basis;
  };
  void apply(const Decision& decision);
  void stamp_next(std::int64_t received, int steps, bool sure, int lost);

  static constexpr int kBlock = 64;  // samples over which the period is measured

  std::int64_t nominal_;
  std::int64_t period_;
  ClockOffset offset_;
  bool running_ = false;
  std::int64_t index_ = 0;       // k of the latest stamped sample
  std::int64_t last_stamp_ = 0;  // us
  std::int64_t last_received_ = 0;
  int stamped_ = 0;          // samples since the start, up to kSettle
  int released_unsure_ = 0;  // samples since the latest stamped one
  int off_phase_ = 0;        // samples since the latest one in phase
  int regular_ = 0;          // of these, the latest in a row that were a period apart
  std::deque<Waiting> waiting_;
  std::vector<Stamp> decided_;
  std::int64_t block_begin_ = 0;                 // us, arrival of the block's first sample
  std::int64_t block_last_ = 0;                  // us, arrival of the previous one
  std::array<std::int64_t, kBlock - 1> gaps_{};  // us, between the block's samples
  int block_size_ = 0;
  std::int64_t last_mean_ = 0;  // us, period of the previous block
  bool last_even_ = false;      // whether its samples arrived evenly
};

}  // namespace curbstone::encoder
