#include "services/ekf/inputs/running_clock.hpp"

#include <cstdlib>
#include <string>

namespace curbstone::ekf::inputs {

namespace {
constexpr std::int64_t kRestart = 1000;  // numbers back: the driver restarted; less is a message out of order
}

std::optional<std::int64_t> RunningClock::add(Sensor sensor, std::int64_t utime, std::int32_t sequence) {
  const bool is_imu = sensor == Sensor::kImu;
  Channel& own = channels_[is_imu ? 0 : 1];
  Channel& other = channels_[is_imu ? 1 : 0];
  const bool consecutive = own.last && std::int64_t{sequence} - own.sequence == 1;
  const std::int64_t behind = std::int64_t{own.sequence} - sequence;
  if (!own.last || behind < 0 || behind > kRestart) own.sequence = sequence;
  const std::int64_t step = own.last ? utime - *own.last : 0;
  const bool is_set = consecutive && own.period > 0 && std::abs(step) <= max_jump_ &&
                      (step < -kMinLeap || step > kMinLeap + own.period);
  if (is_set && step > 0) own.leap = step - own.period, own.leapt_to = utime;
  const bool continues = own.first && consecutive && utime > *own.newest &&
                         utime - *own.newest <= kMinLeap + own.period && std::abs(step) <= max_jump_ &&
                         (step < 0 || step > kMinLeap);
  // The wheels' sequence numbers are those of messages. A step forward is accepted only with the IMU's.
  if (continues || (is_set && (is_imu || step < 0))) return check_step(own, other, utime, continues);
  own.first.reset();
  if (consecutive && step > 0 && step <= max_jump_) own.period = step;
  if (!own.last || step > 0 || std::abs(step) > max_jump_) own.last = utime;
  return utime - own.offset;
}

bool RunningClock::have_both_leapt(const Channel& own, const Channel& other, std::int64_t leap) {
  return std::abs(other.leap - leap) < kSame && std::abs(other.leapt_to - *own.first) < kMinLeap + own.period;
}

std::optional<std::int64_t> RunningClock::check_step(Channel& own, Channel& other, std::int64_t utime, bool continues) {
  if (!continues) own.first = utime;
  own.agreeing = continues ? own.agreeing + 1 : 1;
  own.newest = utime;
  const std::int64_t leap = *own.first - *own.last - own.period;
  const bool confirmed = own.agreeing >= kConfirmations && (leap < 0 || have_both_leapt(own, other, leap));
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
  offset_ = own.offset;
  counters_.add(std::string("clock_set.") + own.name);
  own.last = utime;
  own.first.reset();
  return utime - own.offset;
}

}  // namespace curbstone::ekf::inputs
