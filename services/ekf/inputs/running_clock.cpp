#include "services/ekf/inputs/running_clock.hpp"

#include <cstdlib>
#include <string>

namespace curbstone::ekf::inputs {

namespace {
constexpr std::int64_t kRestart = 1000;  // numbers back: the driver began again; less is a message that was overtaken
}

std::optional<std::int64_t> RunningClock::add(Sensor sensor, std::int64_t utime, std::int32_t sequence) {
  const bool is_imu = sensor == Sensor::kImu;
  Channel& own = channels_[is_imu ? 0 : 1];
  Channel& other = channels_[is_imu ? 1 : 0];
  const bool consecutive = own.last && std::int64_t{sequence} - own.sequence == 1;
  const std::int64_t behind = std::int64_t{own.sequence} - sequence;
  if (!own.last || behind < 0 || behind > kRestart) own.sequence = sequence;
  const std::int64_t step = own.last ? utime - *own.last : 0;
  const bool goes_on =
      own.first && consecutive && utime > *own.newest && utime - *own.newest <= kLeast && (step < 0 || step > kLeast);
  const bool leapt = std::abs(step) <= max_jump_ &&
                     (goes_on || (consecutive && std::abs(step) > kLeast && leaps(own, other, step, is_imu)));
  if (leapt) return doubt(own, other, utime, goes_on);
  own.first.reset();
  if (consecutive && step > 0 && step < kLeast) own.period = step;
  if (!own.last || step > 0 || std::abs(step) > max_jump_) own.last = utime;
  return utime - own.set_by;
}

bool RunningClock::leaps(const Channel& own, const Channel& other, std::int64_t step, bool is_imu) const {
  if (step < 0) return true;
  if (step <= kLeast + own.period) return false;
  return is_imu || std::abs(step - own.period - (other.set_by - own.set_by)) < kSame;
}

std::optional<std::int64_t> RunningClock::doubt(Channel& own, Channel& other, std::int64_t utime, bool consecutive) {
  const bool agrees = own.first && consecutive && utime > *own.newest && utime - *own.newest <= kLeast;
  if (!agrees) own.first = utime;
  own.agreeing = agrees ? own.agreeing + 1 : 1;
  own.newest = utime;
  if (own.agreeing < kConfirmations) {
    counters_.add(std::string("dropped.clock_set.") + own.name);
    return std::nullopt;
  }
  const std::int64_t told = own.set_by + *own.first - *own.last - own.period;
  own.set_by = std::abs(other.set_by - told) < kSame ? other.set_by : told;
  if (other.last && *other.last - *own.last > kLeast && own.set_by > other.set_by) other.set_by = own.set_by;
  set_by_ = own.set_by;
  counters_.add(std::string("clock_set.") + own.name);
  own.last = utime;
  own.first.reset();
  return utime - own.set_by;
}

}  // namespace curbstone::ekf::inputs
