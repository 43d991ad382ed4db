#include "drivers/encoder/period_clock.hpp"

#include <algorithm>
#include <utility>

namespace curbstone::encoder {

namespace {
constexpr std::int64_t kWindow = 3'000'000;  // us, of the offset: longer than two times kSettle periods
constexpr std::int64_t kJump = 1'000'000;
}  // namespace

void PeriodClock::begin(std::int64_t received) {
  offset_ = ClockOffset(kWindow, kJump);
  running_ = true;
  index_ = 0;
  settling_ = 0;
  suspected_ = 0;
  untold_ = 0;
  block_size_ = 0;
  last_received_ = received;
  last_stamp_ = offset_.to_host(0, received);
}

PeriodClock::Stamp PeriodClock::stamp(std::int64_t received, const Evidence& evidence) {
  measure_period(received);
  const std::int64_t gap = received - last_received_;
  const auto begin_anew = [&]() -> Stamp {
    begin(received);
    return {last_stamp_, 1, 0, true};
  };
  if (!running_ || gap > kMaxSleep || gap < 0) return begin_anew();

  Stamp stamp;
  const auto most = static_cast<int>((received - last_stamp_ + period_ / 2) / period_);
  if (most > 1) {
    const std::optional<int> told = evidence(most);
    if (gap > kMaxGap && told != 1) return begin_anew();
    stamp.steps = std::clamp(told.value_or(1), 1, most);
    if (told != 1) untold_ += most - stamp.steps;
  }
  last_received_ = received;
  index_ += stamp.steps;
  acquit(last_stamp_ + stamp.steps * period_ - received);
  stamp.utime = offset_.to_host(index_ * period_, received);

  const std::int64_t delay = received - stamp.utime;
  if (2 * delay < period_) untold_ = 0;
  least_delay_ = settling_ == 0 ? delay : std::min(least_delay_, delay);
  if (++settling_ == kSettle) {
    settling_ = 0;
    if (4 * least_delay_ > 3 * period_ && untold_ > 0) {
      const auto missing = static_cast<int>(std::min(untold_, (least_delay_ + period_ / 4) / period_));
      untold_ -= missing;
      suspected_ += missing;
      suspected_at_ = received;
      index_ += missing;
      stamp.utime = offset_.to_host(index_ * period_, received);
    }
  }
  stamp.lost_before = confirm(received);
  stamp.earlier = std::max<std::int64_t>(last_stamp_ + stamp.steps * period_ - stamp.utime, 0);
  last_stamp_ = stamp.utime;
  return stamp;
}

/// A sample that arrives before its time shows that as many were not lost.
void PeriodClock::acquit(std::int64_t early) {
  if (suspected_ == 0 || 2 * early < period_) return;
  suspected_ = std::max(0, suspected_ - static_cast<int>((early + period_ / 2) / period_));
}

int PeriodClock::confirm(std::int64_t received) {
  if (suspected_ == 0 || received - suspected_at_ < kConfirm) return 0;
  return std::exchange(suspected_, 0);
}

/// A wrong timer unit doubles or halves the period. A pause at a block's end spoils its mean: two blocks must agree.
void PeriodClock::measure_period(std::int64_t received) {
  if (!running_ || block_size_++ == 0) {
    block_begin_ = received;
    return;
  }
  if (block_size_ < kBlock) return;
  const std::int64_t mean = (received - block_begin_) / (kBlock - 1);
  const auto differs = [&](std::int64_t period) { return 5 * std::abs(mean - period) > period; };
  const bool confirmed = 20 * std::abs(mean - last_mean_) < mean;
  last_mean_ = mean;
  block_size_ = 0;
  if (!differs(period_) || !confirmed) return;
  period_ = differs(nominal_) ? std::max<std::int64_t>((mean + 250) / 500 * 500, 500) : nominal_;
  running_ = false;
}

}  // namespace curbstone::encoder
