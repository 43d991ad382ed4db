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
  const bool is_imu = sensor == Sensor::kImu;
  Channel& own = channels_[is_imu ? 0 : 1];
  Channel& other = channels_[is_imu ? 1 : 0];
  const double turned = std::max(std::abs(angles[0] - angles_[0]), std::abs(angles[1] - angles_[1]));
  if (!is_imu) angles_ = angles;
  const std::optional<std::int64_t> out = take(own, other, utime, sequence, turned);
  other.alone = 0;
  ++own.alone;
  if (own.offset == other.offset || !other.last || own.alone > kSilent) offset_ = own.offset;
  return out;
}

/// `turned`: rad, by the wheels since their last sample.
std::optional<std::int64_t> RunningClock::take(Channel& own, Channel& other, std::int64_t utime, std::int32_t sequence,
                                               double turned) {
  const bool is_imu = &own == &channels_[0];
  const bool consecutive = own.last && std::int64_t{sequence} - own.sequence == 1;
  const std::int64_t behind = std::int64_t{own.sequence} - sequence;
  if (!own.last || behind < 0 || behind > kRestart) own.sequence = sequence;
  if (const auto before = std::exchange(own.before_leap, std::nullopt)) {
    const std::int64_t since = utime - *before;
    if (consecutive && since > 0 && since <= kMinLeap + 2 * own.period) own.last = before, own.leap = 0;  // it was wild
  }
  const std::int64_t step = own.last ? utime - *own.last : 0;
  const bool is_set = consecutive && own.period > 0 && (step < -kMinLeap || step > kMinLeap + own.period);
  const bool forward = is_set && step > 0;
  if (forward) {
    own.leap = turned <= kFewIntervals * turn_ + kHardlyTurned ? step - own.period : 0;
    own.leapt_to = utime;
  }
  const bool continues = own.first && consecutive && utime > *own.newest &&
                         utime - *own.newest <= kMinLeap + own.period && (step < 0 || step > kMinLeap);
  // The wheels' sequence numbers are those of messages. A step forward is accepted only with the IMU's.
  if (continues || (is_set && (is_imu || step < 0 || ends_difference(own, other, step - own.period))))
    return check_step(own, other, utime, continues);
  own.first.reset();
  if (forward) own.before_leap = own.last;
  if (consecutive && step > 0 && !forward) own.period = step;
  if (!is_imu && consecutive && !forward) turn_ = std::max(kKept * turn_, turned);
  if (!own.last || step > 0 || step < -kFarBack) own.last = utime;
  return utime - own.offset;
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
