#include "drivers/imu/device/sample_time.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>

namespace curbstone::imu::device {

namespace {

constexpr std::int64_t kDay = 864'000'000;  // ticks
constexpr std::int64_t kFull = std::int64_t{1} << 32;
constexpr std::int64_t kMaxInterval = 10'000;  // ticks, a second
constexpr std::int64_t kRounding = 2;          // ticks: the device rounds at both ends of a step
constexpr std::size_t kMinSteps = 3;

}  // namespace

SampleTime::Result SampleTime::next(std::uint32_t ticks, std::int64_t received, std::optional<int> ahead, int others) {
  others_ = others;
  if (last_) learn(std::int64_t{ticks} - *last_);
  last_ = ticks;
  const Seen seen{ticks, ticks, received};
  const auto believe = [&](Verdict verdict, std::int64_t step) -> Result {
    const bool continues = verdict == Verdict::kContinues && believed_;
    std::int64_t missing = continues ? (interval_ == 0 ? ahead.value_or(1) : intervals(step)) - 1 : 0;
    if (ahead) missing = std::min<std::int64_t>(missing, *ahead - 1);
    missing = std::max<std::int64_t>(missing, continues ? refusals_ : 0);
    believed_ = Seen{ticks, continues ? believed_->unwrapped + step : ticks, received};
    refused_.reset();
    refusals_ = 0;
    return {verdict, believed_->unwrapped * kTick, static_cast<int>(std::min(missing, kDay))};
  };
  if (!believed_) return believe(Verdict::kContinues, 0);
  if (const auto on = step(*believed_, seen, ahead, Strictness::kOnGrid)) return believe(Verdict::kContinues, *on);
  if (ticks == believed_->ticks) return {Verdict::kRepeated, 0, 0};
  if (ahead && *ahead < 0 && interval_ > 0 && ticks < believed_->ticks &&
      on_grid(std::int64_t{believed_->ticks} - ticks) && intervals(std::int64_t{believed_->ticks} - ticks) <= -*ahead) {
    return {Verdict::kLate, 0, 0};
  }
  if (refused_ && step(*refused_, seen, {}, Strictness::kOnGrid)) {
    if (const auto on = step(*believed_, seen, ahead, Strictness::kInOrder)) return believe(Verdict::kContinues, *on);
    learned_ = 0;  // it may sample at another rate now
    interval_ = 0;
    return believe(Verdict::kRestarted, 0);
  }
  refused_ = seen;
  ++refusals_;
  return {Verdict::kRefused, 0, 0};
}

/// Ticks from one time to the next, also across a wrap; empty if it is not a continuation.
std::optional<std::int64_t> SampleTime::step(const Seen& from, const Seen& to, std::optional<int> ahead,
                                             Strictness strictness) const {
  const std::int64_t elapsed = to.received - from.received;
  for (const std::int64_t period : {std::int64_t{0}, kDay, kFull}) {
    const std::int64_t step = std::int64_t{to.ticks} - from.ticks + period;
    if (step <= 0 || (period == kDay && std::max(from.ticks, to.ticks) >= kDay)) continue;
    if (elapsed > kPause && std::abs(step * kTick - elapsed) <= kSlack) return step;
    if (in_order(step, elapsed, ahead) && (strictness == Strictness::kInOrder || on_grid(step))) return step;
  }
  return {};
}

bool SampleTime::in_order(std::int64_t step, std::int64_t elapsed, std::optional<int> ahead) const {
  if (!ahead || interval_ == 0) return step * kTick <= std::max<std::int64_t>(elapsed, 0) + kSlack;
  // Messages of other kinds may be lost as well as samples, so there can be more messages than intervals, but not many.
  return intervals(step - tolerance_) <= *ahead && *ahead <= others_ + 4 * intervals(step) + 8;
}

/// Distance of a step from a multiple of the interval.
std::int64_t SampleTime::off_grid(std::int64_t step) const {
  return interval_ == 0 ? 0 : std::abs(step - intervals(step) * interval_);
}

std::int64_t SampleTime::intervals(std::int64_t step) const {
  return interval_ == 0 ? 1 : std::max<std::int64_t>((step + interval_ / 2) / interval_, 1);
}

double SampleTime::interval() const {
  if (interval_ == 0) return 0;
  std::int64_t sum = 0, count = 0;
  for (std::size_t i = 0; i < std::min(learned_, steps_.size()); ++i) {
    if (!on_grid(steps_[i])) continue;
    sum += steps_[i];
    count += intervals(steps_[i]);
  }
  return static_cast<double>(kTick * (count > 0 ? sum : interval_)) /
         static_cast<double>(std::max<std::int64_t>(count, 1));
}

/// The interval is the median step. The tolerance follows the third largest deviation: one wrong time causes two.
void SampleTime::learn(std::int64_t step) {
  if (step <= 0 || step > kMaxInterval) return;
  steps_[learned_++ % steps_.size()] = step;
  const std::size_t n = std::min(learned_, steps_.size());
  if (n < kMinSteps) return;
  auto sorted = steps_;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n / 2), end);
  interval_ = sorted[n / 2];
  std::transform(sorted.begin(), end, sorted.begin(), [this](std::int64_t s) { return off_grid(s); });
  std::nth_element(sorted.begin(), sorted.begin() + 2, end, std::greater<>());
  tolerance_ = kRounding + 2 * sorted[2];
}

}  // namespace curbstone::imu::device
