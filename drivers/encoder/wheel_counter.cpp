#include "drivers/encoder/wheel_counter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::encoder {

namespace {
constexpr int kMaxSuspects = 3;       // consecutive samples that jump and agree with each other: they are right
constexpr double kAcceleration = 20;  // rad/s^2, of a wheel
constexpr double kUnexplained = 0.5;  // rad, of a wheel that slips for one sample
constexpr double kAtZero = 4;         // counts
}  // namespace

/// Difference modulo 2^32: correct across the wrap.
std::array<double, 2> WheelCounter::difference(const Raw& from, const Raw& to) {
  std::array<double, 2> moved;
  for (std::size_t i = 0; i < 2; ++i) {
    moved[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(to[i]) - static_cast<std::uint32_t>(from[i]));
  }
  return moved;
}

double WheelCounter::step(const Raw& from, const Raw& to) {
  const auto moved = difference(from, to);
  return std::max(std::abs(moved[0]), std::abs(moved[1]));
}

std::optional<WheelCounter::Sample> WheelCounter::update(const Raw& raw, double elapsed) {
  if (has_booted_ && is_near_zero(raw, since_accepted_ + elapsed)) last_.reset();
  if (!last_) {
    has_booted_ = false;
    leap_.restart();
    begin_at(raw);
    return sample({}, elapsed);
  }
  skip(elapsed);
  const std::array<double, 2> moved = difference(*last_, raw);
  const bool has_rate = rate_time_ > 0;
  if (has_rate && (!possible(moved, since_accepted_) || counts_were_reset(raw, moved))) {
    if (!is_lasting_jump(raw, elapsed)) return refuse("refused.jump");
    counters_.add("counts_restarted");
    begin_at(raw);
    return sample({}, elapsed);
  }
  if (is_stale(moved)) return refuse("refused.old_counts");
  if (has_rate ? is_outlier(moved) : is_unconfirmed_start(raw, moved)) return refuse("refused.outlier");
  return accept(raw, moved);
}

/// The counts go on from these. Their rate is to be confirmed.
void WheelCounter::begin_at(const Raw& raw) {
  last_ = raw;
  since_accepted_ = rate_time_ = unknown_ = 0;
  suspects_ = unconfirmed_ = 0;
  rate_ = {};
  second_.reset();
}

WheelCounter::Sample WheelCounter::accept(const Raw& raw, const std::array<double, 2>& moved) {
  const double time = since_accepted_;
  for (std::size_t i = 0; i < 2; ++i) {
    rate_[i] = time > 0 ? moved[i] / time : 0.0;
    const double counts = moved[i] + std::round(rate_[i] * unknown_);
    total_[i] += static_cast<std::int64_t>(settings_.inverted[i] ? -counts : counts);
  }
  last_ = raw;
  rate_time_ = time;
  since_accepted_ = unknown_ = 0;
  suspects_ = unconfirmed_ = 0;
  second_.reset();
  has_booted_ = false;
  return sample(moved, time);
}

std::nullopt_t WheelCounter::refuse(const char* cause) {
  counters_.add(refusal_ = cause);
  return std::nullopt;
}

/// Whether as many samples as are enough have jumped, and agree with each other: they are right, then.
bool WheelCounter::is_lasting_jump(const Raw& raw, double elapsed) {
  const bool agrees = suspects_ > 0 && possible(difference(*suspect_, raw), elapsed);
  suspects_ = agrees ? suspects_ + 1 : 1;
  suspect_ = raw;
  return suspects_ >= kMaxSuspects;
}

void WheelCounter::skip(double elapsed) {
  since_accepted_ += elapsed;
  if (second_) second_->since += elapsed;
}

/// Either count may be rounded at both ends of either interval.
double WheelCounter::tolerance(double time, double rate_time) const {
  const double rounding = 2 + 2 * (rate_time > 0 ? time / rate_time : 1);
  return rounding + kBraking * time * (time + rate_time) / 2 * settings_.counts_per_revolution / (2 * std::numbers::pi);
}

bool WheelCounter::is_outlier(const std::array<double, 2>& moved) {
  const double time = since_accepted_;
  return leap_.refuses({moved[0] - rate_[0] * time, moved[1] - rate_[1] * time}, tolerance(time, rate_time_));
}

/// The first counts may be damaged. They are good if both wheels stand still or have turned alike, forwards or on the
/// spot; else the second sample waits for the third, until two steps agree. If the first step is not confirmed, the
/// counts begin after it, and the rate that is found tells the distance from the first sample, which was published.
bool WheelCounter::is_unconfirmed_start(const Raw& raw, const std::array<double, 2>& moved) {
  const double limit = tolerance(since_accepted_, 0);
  const double least = std::min(std::abs(moved[0]), std::abs(moved[1]));
  const double most = std::max(std::abs(moved[0]), std::abs(moved[1]));
  const bool can_be = possible(moved, since_accepted_);
  const bool alike = most - least <= 2 * limit;  // both stand, too
  if (can_be && (alike || unconfirmed_ >= kMaxUnconfirmed)) return false;
  ++unconfirmed_;
  if (second_) {
    const double time = second_->since;
    const double ratio = second_->time > 0 ? time / second_->time : 1;
    const std::array<double, 2> step = difference(second_->raw, raw);
    const double change =
        std::max(std::abs(step[0] - ratio * second_->moved[0]), std::abs(step[1] - ratio * second_->moved[1]));
    if (can_be && possible(step, time) && change <= tolerance(time, second_->time)) return false;
    unknown_ += second_->time;
    last_ = second_->raw;
    since_accepted_ = time;
    second_ = Second{raw, step, time};
  } else {
    second_ = Second{raw, moved, since_accepted_};
  }
  return true;
}

bool WheelCounter::possible(const std::array<double, 2>& moved, double time) const {
  const double limit = settings_.max_speed * settings_.counts_per_revolution / (2 * std::numbers::pi);
  return std::abs(moved[0]) <= limit * time && std::abs(moved[1]) <= limit * time;
}

/// Whether the wheels can have turned that far from zero within `time` s.
bool WheelCounter::is_near_zero(const Raw& raw, double time) const {
  return possible({static_cast<double>(raw[0]), static_cast<double>(raw[1])}, time);
}

double WheelCounter::accelerated(double time) const {
  return kAcceleration * time * time / 2 * settings_.counts_per_revolution / (2 * std::numbers::pi);
}

/// The rate may be wrong by its own magnitude, because stamps jitter.
bool WheelCounter::explained(std::size_t wheel, double moved, double time) const {
  const double tolerance = accelerated(time) + kUnexplained * settings_.counts_per_revolution / (2 * std::numbers::pi);
  return std::abs(moved - rate_[wheel] * time) <= tolerance + std::abs(rate_[wheel]) * time;
}

/// Whether both counts are within a wheel's turn from zero since the latest sample, and one has leapt there: the drive
/// has lost its supply, or its counts were reset.
bool WheelCounter::counts_were_reset(const Raw& raw, const std::array<double, 2>& moved) const {
  bool leapt = false;
  for (std::size_t i = 0; i < 2; ++i) {
    const double now = std::abs(static_cast<double>(raw[i]));
    const double before = std::abs(static_cast<double>((*last_)[i]));
    if (now > std::abs(rate_[i]) * since_accepted_ + accelerated(since_accepted_) + kAtZero) return false;
    leapt = leapt || (now < before && !explained(i, moved[i], since_accepted_));
  }
  return leapt;
}

bool WheelCounter::is_stale(const std::array<double, 2>& moved) const {
  const double radians = 2 * std::numbers::pi / settings_.counts_per_revolution;
  const auto has_no_time_to_stop = [&](double rate) {
    return std::abs(rate) * since_accepted_ >= kTooFast && since_accepted_ < std::abs(rate) * radians / kBraking;
  };
  return (moved[0] == 0 && has_no_time_to_stop(rate_[0])) || (moved[1] == 0 && has_no_time_to_stop(rate_[1]));
}

bool WheelCounter::is_possible(const Raw& raw, double elapsed) const {
  return !last_ || possible(difference(*last_, raw), since_accepted_ + elapsed);
}

WheelCounter::Sample WheelCounter::sample(const std::array<double, 2>& moved, double elapsed) const {
  const double radians = 2 * std::numbers::pi / settings_.counts_per_revolution;
  Sample sample;
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = settings_.inverted[i] ? -1 : 1;
    sample.counts[i] = total_[i];
    sample.angle[i] = static_cast<double>(total_[i]) * radians;
    sample.speed[i] = elapsed > 0 ? sign * moved[i] * radians / elapsed : 0.0;
  }
  return sample;
}

std::optional<int> WheelCounter::likely_periods(const Raw& raw, int least, int most, double period) const {
  if (!last_) return {};
  // Before a rate is confirmed, that of the first step is the best one known.
  const bool by_first = rate_time_ == 0 && second_ && second_->time > 0;
  const double rate_time = by_first ? second_->time : rate_time_;
  std::array<double, 2> rate = rate_;
  if (by_first) rate = {second_->moved[0] / second_->time, second_->moved[1] / second_->time};
  const double before =
      (by_first ? second_->since : since_accepted_) / period;  // of samples that were refused or passed
  const std::array<double, 2> moved = difference(by_first ? second_->raw : *last_, raw);
  const auto residual = [&](int periods) {  // counts
    const double time = (before + periods) * period;
    return std::abs(moved[0] - rate[0] * time) + std::abs(moved[1] - rate[1] * time);
  };
  int best = least;
  for (int periods = least + 1; periods <= most; ++periods) {
    if (residual(periods) < residual(best)) best = periods;
  }
  // Undecided if more than a quarter of the turn in a period is unexplained, or the doubt, to both sides, exceeds half.
  const double turned = (std::abs(rate[0]) + std::abs(rate[1])) * period;
  const double periods = before + best;
  const double time = periods * period;
  const double by_acceleration = kAcceleration * time * (time + rate_time) / 2;  // rad
  const double uncertainty =
      by_acceleration * settings_.counts_per_revolution / (2 * std::numbers::pi) + 1 + 0.5 * periods;
  if (residual(best) > 0.25 * turned || 2 * uncertainty > 0.5 * turned) return {};
  return best;
}

double WheelCounter::most_turned(double elapsed) const {
  return std::max(std::abs(rate_[0]), std::abs(rate_[1])) * elapsed + accelerated(elapsed);
}

bool WheelCounter::turns_fast(double period) const {
  return std::max(std::abs(rate_[0]), std::abs(rate_[1])) * period >= kTooFast;
}

}  // namespace curbstone::encoder
