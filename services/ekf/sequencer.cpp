#include "services/ekf/sequencer.hpp"

namespace curbstone {

namespace {

constexpr std::size_t kMaxQueue = 2048;  // samples; 1 s of hold at 2 kHz

std::int64_t microseconds(double seconds) {
  return static_cast<std::int64_t>(seconds / kSecondsPerMicrosecond);
}

}  // namespace

Sequencer::Sequencer(const TimingConfig& config)
    : hold_(microseconds(config.hold)),
      imu_("imu", microseconds(config.max_jump)),
      wheels_("wheels", microseconds(config.max_jump)) {}

template <class T, class Other>
void Sequencer::take(Channel<T>& own, Channel<Other>& other, const T& sample) {
  const auto drop = [&](const char* cause) { counters_.add(std::string("dropped.") + cause + "." + own.name); };
  switch (own.guard.judge(sample.utime)) {
    case StampGuard::Verdict::kDuplicate:
      return drop("duplicate");
    case StampGuard::Verdict::kBackwards:
      return drop("backwards");
    case StampGuard::Verdict::kSuspicious:
      return drop("stray_stamp");
    case StampGuard::Verdict::kJumped:
      counters_.add(std::string("jumps.") + own.name);
      if (sample.utime < own.newest) turn_clock_back(own, other);
      break;
    case StampGuard::Verdict::kGood:
      break;
  }
  if (sample.utime <= processed_) {
    counters_.add("dropped.late");
    return drop("late");
  }
  own.newest = sample.utime;
  own.queue.push_back(sample);
  if (own.queue.size() > kMaxQueue) {
    own.queue.pop_front();
    drop("queue");
  }
}

void Sequencer::push(const ImuSample& sample) {
  take(imu_, wheels_, sample);
}

void Sequencer::push(const WheelSample& sample) {
  take(wheels_, imu_, sample);
}

/// Whatever waits belongs to the old time, and the other sensor's next stamp may be of either.
template <class T, class Other>
void Sequencer::turn_clock_back(Channel<T>& own, Channel<Other>& other) {
  counters_.add("dropped.clock_turned_back", static_cast<std::int64_t>(own.queue.size() + other.queue.size()));
  own.queue.clear();
  other.queue.clear();
  other.guard.reset();
  other.newest = kNever;
  processed_ = kNever;
}

template <class T, class Other>
std::optional<Sequencer::Sample> Sequencer::pop_front(Channel<T>& own, const Channel<Other>& other, bool drain) {
  const std::int64_t utime = own.queue.front().utime;
  const bool due = drain || other.newest >= utime || own.newest - utime >= hold_;
  if (!due) return std::nullopt;
  Sample sample = own.queue.front();
  own.queue.pop_front();
  processed_ = utime;
  return sample;
}

std::optional<Sequencer::Sample> Sequencer::pop(bool drain) {
  if (imu_.queue.empty() && wheels_.queue.empty()) return std::nullopt;
  const bool wheels_first =
      imu_.queue.empty() || (!wheels_.queue.empty() && wheels_.queue.front().utime <= imu_.queue.front().utime);
  return wheels_first ? pop_front(wheels_, imu_, drain) : pop_front(imu_, wheels_, drain);
}

}  // namespace curbstone
