#include "services/ekf/inputs/sequencer.hpp"

#include "common/time/microseconds.hpp"

namespace curbstone::ekf::inputs {

namespace {

constexpr std::size_t kMaxQueue = 2048;     // samples; 1 s of hold at 2 kHz
constexpr std::size_t kMaxIncrements = 64;  // one per 0.05 s, 1 s of delay, and a margin

}  // namespace

Sequencer::Sequencer(const base::EkfConfig& config)
    : hold_(microseconds(config.timing.hold)),
      history_(microseconds(config.timing.history)),
      delay_(microseconds(config.map.delay)),
      imu_("imu", microseconds(config.timing.max_jump)),
      wheels_("wheels", microseconds(config.timing.max_jump)) {}

template <class T, class Other>
void Sequencer::take(Channel<T>& own, Channel<Other>& other, const T& sample) {
  const auto drop = [&](const char* cause) { counters_.add(std::string("dropped.") + cause + "." + own.name); };
  switch (own.guard.judge(sample.utime)) {
    case StampGuard::Verdict::kDuplicate:
      return drop("duplicate");
    case StampGuard::Verdict::kSuspicious:
      return drop("stray_stamp");
    case StampGuard::Verdict::kJumped:
      counters_.add(std::string("jumps.") + own.name);
      if (sample.utime < own.newest) on_clock_set_back(own, other);
      break;
    case StampGuard::Verdict::kBackwards:
    case StampGuard::Verdict::kGood:
      break;
  }
  const std::int64_t due = std::max(own.newest, sample.utime);
  if (const std::int64_t front = std::max(processed_, due); front != kNever && sample.utime < front - history_) {
    counters_.add("dropped.late");
    return drop("late");
  }
  if (sample.utime < own.newest) counters_.add(std::string("disordered.") + own.name);
  own.newest = due;
  own.queue.push_back({due, sample});
  if (own.queue.size() > kMaxQueue) {
    own.queue.pop_front();
    drop("queue");
  }
}

void Sequencer::push(const base::ImuSample& sample) {
  take(imu_, wheels_, sample);
}

void Sequencer::push(const base::WheelSample& sample) {
  take(wheels_, imu_, sample);
}

void Sequencer::push(const MapIncrement& increment) {
  const std::int64_t due = increment.utime + delay_;
  if (due < processed_ || (!increments_.empty() && due <= increments_.back().utime))
    return counters_.add("dropped.late.map");
  increments_.push_back({due, increment});
  if (increments_.size() > kMaxIncrements) {
    increments_.pop_front();
    counters_.add("dropped.queue.map");
  }
}

void Sequencer::drop_wheels_after(std::int64_t utime) {
  if (wheels_.newest <= utime) return;
  const auto later = std::erase_if(wheels_.queue, [&](const auto& entry) { return entry.utime > utime; });
  counters_.add("dropped.clock_set.wheels", static_cast<std::int64_t>(later));
  wheels_.newest = utime;
  wheels_.guard.reset();
}

/// Drops waiting samples, which belong to the old time; the other sensor's next stamp may be of either time.
template <class T, class Other>
void Sequencer::on_clock_set_back(Channel<T>& own, Channel<Other>& other) {
  counters_.add("dropped.clock_turned_back", static_cast<std::int64_t>(own.queue.size() + other.queue.size()));
  own.queue.clear();
  other.queue.clear();
  increments_.clear();
  other.guard.reset();
  own.newest = kNever;
  other.newest = kNever;
  processed_ = kNever;
}

bool Sequencer::are_wheels_next() const {
  return imu_.queue.empty() || (!wheels_.queue.empty() && wheels_.queue.front().utime <= imu_.queue.front().utime);
}

template <class T, class Other>
bool Sequencer::is_due(const Channel<T>& own, const Channel<Other>& other) const {
  const std::int64_t due = own.queue.front().utime;
  return other.newest >= due || own.newest - due >= hold_;
}

/// The first sample of a channel, or a map increment that goes before it.
template <class T>
Sequencer::Sample Sequencer::pop_front(Channel<T>& own) {
  const std::int64_t due = own.queue.front().utime;
  processed_ = std::max(processed_, due);
  if (!increments_.empty() && increments_.front().utime < due) {
    Sample increment = increments_.front().sample;
    increments_.pop_front();
    return increment;
  }
  Sample sample = own.queue.front().sample;
  own.queue.pop_front();
  return sample;
}

std::optional<Sequencer::Sample> Sequencer::pop() {
  if (empty()) return std::nullopt;
  const bool due = are_wheels_next() ? is_due(wheels_, imu_) : is_due(imu_, wheels_);
  return due ? pop_rest() : std::nullopt;
}

std::optional<Sequencer::Sample> Sequencer::pop_rest() {
  if (empty()) return std::nullopt;
  return are_wheels_next() ? pop_front(wheels_) : pop_front(imu_);
}

}  // namespace curbstone::ekf::inputs
