#include "services/ekf/inputs/running_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

namespace curbstone::ekf::inputs {

namespace {
constexpr std::int64_t kRestart = 1000;       // numbers back: the driver restarted; less is a message out of order
constexpr std::int64_t kFarBack = 1'000'000;  // us: no message is that late
constexpr double kFewIntervals = 4.0;         // in which a wheel turns less than while a driver pauses
constexpr double kHardlyTurned = 0.03;        // rad
constexpr double kKept = 0.98;                // of the fastest turn, from sample to sample
}  // namespace

std::optional<std::int64_t> RunningClock::add(Sensor sensor, std::int64_t utime, std::int32_t sequence,
                                              const std::array<double, 2>& angles) {
  const double turned = std::max(std::abs(angles[0] - angles_[0]), std::abs(angles[1] - angles_[1]));
  if (sensor == Sensor::kWheels) angles_ = angles;
  const std::optional<std::int64_t> out = take(sensor, utime, sequence, turned);
  Channel& heard = channel(sensor);
  counterpart(sensor).alone = 0;
  ++heard.alone;
  if (heard.offset == counterpart(sensor).offset || !counterpart(sensor).last || heard.alone > kSilent)
    offset_ = heard.offset;
  return out;
}

/// `turned`: rad, by the wheels since their last sample.
std::optional<std::int64_t> RunningClock::take(Sensor sensor, std::int64_t utime, std::int32_t sequence,
                                               double turned) {
  Channel& heard = channel(sensor);
  const bool consecutive = heard.is_next(sequence);
  heard.note_number(sequence);
  heard.forget_wild_leap(utime, consecutive);
  const std::int64_t step = heard.last ? utime - *heard.last : 0;
  const bool is_set = consecutive && heard.may_be_set(step);
  const bool is_leap = is_set && step > 0;
  const std::int64_t leap = step - heard.period;
  if (is_leap) {
    heard.leap = turned <= kFewIntervals * turn_ + kHardlyTurned ? leap : 0;
    heard.leapt_to = utime;
  }
  const bool continues = consecutive && heard.continues_new_clock(utime, step);
  // The wheels' sequence numbers are those of messages. A step forward is accepted only with the IMU's.
  const bool is_candidate =
      is_set && (sensor == Sensor::kImu || step < 0 || ends_difference(heard, counterpart(sensor), leap));
  if (continues || is_candidate) return check_step(heard, counterpart(sensor), utime, continues);
  heard.first.reset();
  if (is_leap) heard.before_leap = heard.last;
  if (consecutive && !is_leap) {
    if (step > 0) heard.period = step;
    if (sensor == Sensor::kWheels) turn_ = std::max(kKept * turn_, turned);
  }
  if (!heard.last || step > 0 || step < -kFarBack) heard.last = utime;
  return utime - heard.offset;
}

bool RunningClock::Channel::is_next(std::int32_t number) const {
  return last && std::int64_t{number} - sequence == 1;
}

void RunningClock::Channel::note_number(std::int32_t number) {
  const std::int64_t behind = std::int64_t{sequence} - number;
  if (!last || behind < 0 || behind > kRestart) sequence = number;
}

void RunningClock::Channel::forget_wild_leap(std::int64_t utime, bool consecutive) {
  const auto before = std::exchange(before_leap, std::nullopt);
  if (!before || !consecutive) return;
  const std::int64_t since = utime - *before;
  if (since <= 0 || since > kMinLeap + 2 * period) return;
  last = before;
  leap = 0;
}

bool RunningClock::Channel::may_be_set(std::int64_t step) const {
  return period > 0 && (step < -kMinLeap || step > kMinLeap + period);
}

bool RunningClock::Channel::continues_new_clock(std::int64_t utime, std::int64_t step) const {
  return first && utime > *newest && utime - *newest <= kMinLeap + period && (step < 0 || step > kMinLeap);
}

bool RunningClock::have_both_leapt(const Channel& own, const Channel& other, std::int64_t leap) {
  return std::abs(other.leap - leap) < kSame && std::abs(other.leapt_to - *own.first) < kMinLeap + own.period;
}

bool RunningClock::ends_difference(const Channel& own, const Channel& other, std::int64_t leap) {
  return own.offset != other.offset && std::abs(own.offset + leap - other.offset) < kSame;
}

std::optional<std::int64_t> RunningClock::check_step(Channel& own, Channel& other, std::int64_t utime, bool continues) {
  if (!continues) own.first = utime;
  own.agreeing = continues ? own.agreeing + 1 : 1;
  own.newest = utime;
  const std::int64_t leap = *own.first - *own.last - own.period;
  const bool explained = leap < 0 || have_both_leapt(own, other, leap) || ends_difference(own, other, leap);
  const bool confirmed = own.agreeing >= kConfirmations && explained;
  if (!confirmed && leap > 0 && utime - *own.first > kPatience) {  // the sensor was silent
    own.last = utime;
    own.first.reset();
    return utime - own.offset;
  }
  if (!confirmed) {
    counters_.add(std::string("dropped.clock_set.") + own.name);
    return std::nullopt;
  }
  const std::int64_t offset = own.offset + leap;
  own.offset = std::abs(other.offset - offset) < kSame ? other.offset : offset;
  if (other.last && *other.last - *own.last > kMinLeap && own.offset > other.offset) other.offset = own.offset;
  counters_.add(std::string("clock_set.") + own.name);
  own.last = utime;
  own.first.reset();
  return utime - own.offset;
}

}  // namespace curbstone::ekf::inputs
