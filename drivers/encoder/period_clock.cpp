#include "drivers/encoder/period_clock.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace curbstone::encoder {

namespace {
constexpr std::int64_t kWindow = 3'000'000;  // us, of the offset
constexpr std::int64_t kJump = 1'000'000;
constexpr std::int64_t kPunctual = 800;  // us: a sample that is later by no more is on the period
constexpr std::int64_t kEarly = 300;     // us: nor earlier by more
constexpr int kMaxUnsure = 1000;         // released as unsure
constexpr int kMinPunctual = PeriodClock::kSettle * 6 / 10;
}  // namespace

/// Restarts. The waiting samples are released as unsure: how much time has passed is unknown.
void PeriodClock::begin(std::int64_t received) {
  for (const Waiting& waiting : waiting_) decided_.push_back({.utime = waiting.received, .sure = false});
  waiting_.clear();
  released_unsure_ = 0;
  offset_ = ClockOffset(kWindow, kJump);
  running_ = true;
  index_ = 0;
  stamped_ = 0;
  off_phase_ = 0;
  block_size_ = 0;
  last_stamp_ = offset_.to_host(0, received);
  decided_.push_back({.utime = last_stamp_, .restarted = true});
}

const std::vector<PeriodClock::Stamp>& PeriodClock::stamp(std::int64_t received, const Evidence& evidence) {
  decided_.clear();
  measure_period(received);
  const std::int64_t gap = received - last_received_;
  last_received_ = received;
  if (!running_ || gap > kMaxSleep || gap < 0 || has_other_phase()) {
    begin(received);
    return decided_;
  }
  if (is_off_phase(received)) {
    add_off_phase(received, gap);
    return decided_;
  }
  if (waiting_.size() == kMaxWaiting) release_oldest();
  const int least = static_cast<int>(waiting_.size()) + 1;  // periods since the last stamped sample
  const std::int64_t delay = received - (offset_.offset() + (index_ + least) * period_);
  const int most = most_missing(delay);
  std::optional<int> missing = 0;
  if (most > 0) {
    missing = evidence(least, least + most);
    if (missing) *missing = std::clamp(*missing - least, 0, most);
  }
  if (gap > kMaxGap && missing != 0) {
    begin(received);
    return decided_;
  }
  waiting_.push_back({received, delay, missing});
  if (most == 0) {
    apply({.missing = 0, .first_certain = 0, .last = waiting_.size() - 1, .basis = Basis::kArrivals});
  } else {
    decide_by_evidence();
    decide_by_regularity();
  }
  return decided_;
}

bool PeriodClock::is_off_phase(std::int64_t received) const {
  if (stamped_ < kSettle || !waiting_.empty()) return false;
  return off_phase_ > 0 || received < offset_.offset() + (index_ + 1) * period_ - tolerance();
}

/// Takes a sample after one that was off phase. Whatever the period is now, a sample that is in phase was taken
/// at that time, and the number of periods since the last one follows from it.
void PeriodClock::add_off_phase(std::int64_t received, std::int64_t gap) {
  const std::int64_t since = received - offset_.offset() - index_ * period_;
  const auto steps = static_cast<int>((since + kEarly) / period_);
  ++off_phase_;
  regular_ = std::abs(gap - period_) <= period_ / 8 ? regular_ + 1 : 0;
  if (off_phase_ > 1 && steps >= 1 && since - steps * period_ <= tolerance()) {
    stamp_next(received, steps, true, std::max(steps - off_phase_, 0));
  } else if (regular_ >= kRegular || off_phase_ >= kMaxWaiting) {
    begin(received);
  } else {
    decided_.push_back({.utime = received, .steps = 0, .sure = false});
  }
}

bool PeriodClock::is_early(std::int64_t received) const {
  if (!running_ || stamped_ < kSettle || received < last_received_) return false;
  const auto next = index_ + static_cast<std::int64_t>(waiting_.size()) + 1;
  return received < offset_.offset() + next * period_ - period_ / 4;
}

/// us by which a sample may have been taken earlier than the offset says. At the start the delay of the best sample is
/// unknown.
std::int64_t PeriodClock::tolerance() const {
  return stamped_ < kSettle ? period_ / 2 : period_ / 8;
}

int PeriodClock::most_missing(std::int64_t delay) const {
  return static_cast<int>(std::max<std::int64_t>(delay + tolerance(), 0) / period_);
}

void PeriodClock::decide_by_evidence() {
  const std::optional<int> missing = waiting_.back().missing;
  if (!missing) return;
  const auto agrees = [&](const Waiting& waiting) { return waiting.missing == missing; };
  const auto first = std::find_if(waiting_.begin(), waiting_.end(), agrees);
  const auto position = static_cast<std::size_t>(first - waiting_.begin());
  if (position + 1 == waiting_.size()) return;
  apply({.missing = *missing, .first_certain = position, .last = waiting_.size() - 1, .basis = Basis::kEvidence});
}

/// Number of the last kSettle waiting samples that arrived within kPunctual of `delay`.
int PeriodClock::count_punctual(std::int64_t delay) const {
  const auto close = [&](const Waiting& waiting) { return is_punctual(waiting.delay - delay); };
  return static_cast<int>(std::count_if(waiting_.end() - kSettle, waiting_.end(), close));
}

bool PeriodClock::is_punctual(std::int64_t delay) const {
  return delay >= -kEarly && delay <= std::min(kPunctual, period_ / 8);
}

std::int64_t PeriodClock::min_delay() const {
  const auto by_delay = [](const Waiting& a, const Waiting& b) { return a.delay < b.delay; };
  return std::min_element(waiting_.end() - kSettle, waiting_.end(), by_delay)->delay;
}

/// The first sample on the period may be a late one that looks punctual: decides from the second one on.
void PeriodClock::decide_by_regularity() {
  if (waiting_.size() < kSettle) return;
  const int missing = most_missing(min_delay());
  if (count_punctual(missing * period_) < kMinPunctual) return;
  const auto punctual = [&](const Waiting& waiting) { return is_punctual(waiting.delay - missing * period_); };
  const auto begin = waiting_.end() - kSettle;
  const auto first = std::find_if(std::find_if(begin, waiting_.end(), punctual) + 1, waiting_.end(), punctual);
  const auto last = std::find_if(waiting_.rbegin(), waiting_.rend(),
                                 [&](const Waiting& waiting) { return most_missing(waiting.delay) == missing; });
  apply({.missing = missing,
         .first_certain = static_cast<std::size_t>(first - waiting_.begin()),
         .last = static_cast<std::size_t>(std::distance(last, waiting_.rend())) - 1,
         .basis = Basis::kArrivals});
}

/// Whether the waiting samples keep a phase of their own, because the device was stopped meanwhile, or no decision is
/// in sight.
bool PeriodClock::has_other_phase() const {
  if (waiting_.size() < kMaxWaiting) return false;
  return released_unsure_ >= kMaxUnsure || count_punctual(min_delay()) >= kMinPunctual;
}

void PeriodClock::release_oldest() {
  stamp_next(waiting_.front().received, 1, false, 0);
  waiting_.pop_front();
  ++released_unsure_;
}

/// Stamps the waiting samples up to `last`. The number of missing samples never decreases, so by evidence those before
/// `first_certain` are accepted, too, if their own number fits.
void PeriodClock::apply(const Decision& decision) {
  const int missing = decision.missing;
  released_unsure_ = 0;
  int lost_so_far = 0;
  for (std::size_t i = 0; i <= decision.last; ++i) {
    const Waiting waiting = waiting_.front();
    waiting_.pop_front();
    std::optional<int> missing_before;
    if (missing == 0 || i >= decision.first_certain) {
      missing_before = missing;
    } else if (decision.basis == Basis::kEvidence && waiting.missing && *waiting.missing >= lost_so_far &&
               *waiting.missing <= missing) {
      missing_before = waiting.missing;
    }
    const int lost = missing_before ? *missing_before - lost_so_far : 0;
    stamp_next(waiting.received, 1 + lost, missing_before.has_value(), lost);
    lost_so_far = missing_before.value_or(lost_so_far);
  }
  for (Waiting& waiting : waiting_) {
    waiting.delay -= missing * period_;
    if (waiting.missing) *waiting.missing = std::max(*waiting.missing - missing, 0);
  }
}

void PeriodClock::stamp_next(std::int64_t received, int steps, bool sure, int lost) {
  off_phase_ = regular_ = 0;
  index_ += steps;
  const std::int64_t expected = last_stamp_ + steps * period_;
  if (!sure) {
    last_stamp_ = expected;
    decided_.push_back({.utime = received, .sure = false});
    return;
  }
  last_stamp_ = offset_.to_host(index_ * period_, received);
  stamped_ = std::min(stamped_ + 1, kSettle);
  decided_.push_back({.utime = last_stamp_,
                      .steps = steps,
                      .lost = lost,
                      .earlier = std::max<std::int64_t>(expected - last_stamp_, 0)});
}

/// A wrong timer unit doubles or halves the period; another drive has its own. A pause at a block's end falsifies its
/// mean: two blocks must agree. A small difference counts only if samples arrive evenly: lost samples change the mean,
/// and bunches the median.
void PeriodClock::measure_period(std::int64_t received) {
  if (!running_ || block_size_++ == 0) {
    block_begin_ = block_last_ = received;
    return;
  }
  gaps_[static_cast<std::size_t>(block_size_ - 2)] = received - std::exchange(block_last_, received);
  if (block_size_ < kBlock) return;
  const std::int64_t mean = (received - block_begin_) / (kBlock - 1);
  constexpr std::size_t kMiddle = (kBlock - 1) / 2;
  std::nth_element(gaps_.begin(), gaps_.begin() + kMiddle, gaps_.end());
  const bool even = 50 * std::abs(gaps_[kMiddle] - mean) < mean;
  const std::int64_t share = even && last_even_ ? 20 : 5;
  const auto differs = [&](std::int64_t period) { return share * std::abs(mean - period) > period; };
  const bool confirmed = 20 * std::abs(mean - last_mean_) < mean;
  last_mean_ = mean;
  last_even_ = even;
  block_size_ = 0;
  if (!differs(period_) || !confirmed) return;
  const std::int64_t step = even ? 100 : 500;
  period_ = differs(nominal_) ? std::max((mean + step / 2) / step * step, std::int64_t{500}) : nominal_;
  running_ = false;
}

}  // namespace curbstone::encoder
