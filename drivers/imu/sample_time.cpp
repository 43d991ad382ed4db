#include "drivers/imu/sample_time.hpp"

#include <algorithm>
#include <cstdlib>

namespace curbstone::imu {

namespace {

constexpr std::int64_t kDay = 864'000'000;  // ticks
constexpr std::int64_t kFull = std::int64_t{1} << 32;
constexpr std::int64_t kLongestInterval = 10'000;  // ticks, a second
constexpr std::int64_t kGridError = 2;             // ticks: the device rounds, on both sides
constexpr std::size_t kFewestSteps = 3;

}  // namespace

SampleTime::Result SampleTime::next(std::uint32_t ticks, std::int64_t received, std::optional<int> ahead) {
  if (last_) learn_interval(std::int64_t{ticks} - *last_);
  last_ = ticks;
  if (!believed_) {
    believed_ = Seen{ticks, ticks, received};
    return {Verdict::kContinues, ticks * kTick, 0};
  }
  if (const auto on = step(*believed_, ticks, received, ahead)) {
    believed_ = Seen{ticks, believed_->unwrapped + *on, received};
    refused_.reset();
    const std::int64_t missing = interval_ == 0 ? std::max(ahead.value_or(1), 1) - 1 : intervals(*on) - 1;
    return {Verdict::kContinues, believed_->unwrapped * kTick, static_cast<int>(std::min(missing, kDay))};
  }
  if (ticks == believed_->ticks) return {Verdict::kRepeated, 0, 0};
  if (refused_ && step(*refused_, ticks, received, {})) {
    believed_ = Seen{ticks, ticks, received};
    refused_.reset();
    return {Verdict::kRestarted, ticks * kTick, 0};
  }
  refused_ = Seen{ticks, ticks, received};
  return {Verdict::kRefused, 0, 0};
}

/// From one time to the next, across a wrap too, in ticks; empty if it does not continue it.
std::optional<std::int64_t> SampleTime::step(const Seen& from, std::uint32_t ticks, std::int64_t received,
                                             std::optional<int> ahead) const {
  for (const std::int64_t period : {std::int64_t{0}, kDay, kFull}) {
    const std::int64_t step = std::int64_t{ticks} - from.ticks + period;
    if (period == kDay && std::max(from.ticks, ticks) >= kDay) continue;
    if (plausible(step, received - from.received, ahead)) return step;
  }
  return {};
}

bool SampleTime::plausible(std::int64_t step, std::int64_t elapsed, std::optional<int> ahead) const {
  if (step <= 0) return false;
  if (elapsed > kPause && std::abs(step * kTick - elapsed) <= kSlack) return true;
  if (!on_grid(step)) return false;
  // Messages of other kinds may be lost beside the samples, so there can be more messages than intervals; but not many.
  if (ahead && interval_ > 0) return intervals(step) <= *ahead && *ahead <= 4 * intervals(step) + 8;
  return step * kTick <= std::max<std::int64_t>(elapsed, 0) + kSlack;
}

bool SampleTime::on_grid(std::int64_t step) const {
  if (interval_ == 0) return true;
  const std::int64_t n = intervals(step);
  return std::abs(step - n * interval_) <= kGridError + n / 2;  // an interval is known to half a tick
}

std::int64_t SampleTime::intervals(std::int64_t step) const {
  return std::max<std::int64_t>((step + interval_ / 2) / interval_, 1);
}

/// The interval is the median step, if most steps are multiples of it.
void SampleTime::learn_interval(std::int64_t step) {
  if (step <= 0 || step > kLongestInterval) return;
  steps_[learned_++ % steps_.size()] = step;
  const std::size_t n = std::min(learned_, steps_.size());
  if (n < kFewestSteps) return;
  auto sorted = steps_;
  std::nth_element(sorted.begin(), sorted.begin() + n / 2, sorted.begin() + static_cast<std::ptrdiff_t>(n));
  interval_ = sorted[n / 2];
  const auto on = std::count_if(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(n),
                                [this](std::int64_t s) { return on_grid(s); });
  if (3 * on < 2 * static_cast<std::int64_t>(n)) interval_ = 0;
}

}  // namespace curbstone::imu
