#include "drivers/encoder/signals/wheel_signals.hpp"

#include <algorithm>

namespace curbstone::encoder::signals {

std::optional<WheelSignals::Values> WheelSignals::on_frame(std::int64_t time, const can::CanFrame& frame) {
  const std::array<bool, 2> ours = {signals_[0].is_in(frame), signals_[1].is_in(frame)};
  if (!ours[0] && !ours[1]) {
    counters_.add("ignored.frames");
    return {};
  }
  std::array<std::optional<std::int64_t>, 2> raw;
  for (std::size_t i = 0; i < 2; ++i) {
    if (ours[i]) raw[i] = signals_[i].raw(frame);
    if (!ours[i] || raw[i]) continue;
    counters_.add("refused.length");
    return {};
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (raw[i]) take(i, *raw[i]);
  }
  if (ours[0] != ours[1]) {
    const std::size_t wheel = ours[0] ? 0 : 1;
    learn(wheel, time);
    if (!completes(wheel)) return {};
  }
  Values values;
  for (std::size_t i = 0; i < 2; ++i) {
    values.counts[i] = static_cast<std::int32_t>(static_cast<std::uint64_t>(unwrapped_[i]));
    values.values[i] = signals_[i].value(*last_[i]);
  }
  return values;
}

/// A wheel's frame twice in a row is not used: the other wheel's frame was lost.
void WheelSignals::learn(std::size_t wheel, std::int64_t time) {
  if (!leads_) leads_ = wheel;
  pause_ = newest_ ? std::max<double>(0, static_cast<double>(time - newest_time_)) : 0;
  if (newest_ && *newest_ != wheel && time >= newest_time_) {
    Pause& pause = pauses_[wheel];
    pause.count = std::min(pause.count + 1, kLearn);
    const double most = knows_cycle() ? kMaxPause * cycle() : pause_;  // the host was late
    pause.mean += (std::min(pause_, most) - pause.mean) / pause.count;
    const Pause& first = pauses_[*leads_];
    const Pause& second = pauses_[1 - *leads_];
    const double clearly = knows_cycle() ? kClearly : kAtOnce;
    if (first.count > 0 && second.count > 0 && second.mean > clearly * first.mean) {
      leads_ = 1 - *leads_;
      waits_ = false;
    }
  }
  newest_ = wheel;
  newest_time_ = time;
}

/// Whether this wheel's frame is the second of a pair.
bool WheelSignals::completes(std::size_t wheel) {
  const bool leads = wheel == *leads_;
  const bool of_two_times = !leads && waits_ && knows_cycle() && pause_ > pauses_[wheel].mean + kApart * cycle();
  if (leads == waits_ || of_two_times) counters_.add("lost.halves", of_two_times ? 2 : 1);
  const bool pair = !leads && waits_ && !of_two_times;
  waits_ = leads;
  return pair;
}

/// Unwraps by the shortest difference: a counter of n bits wraps at 2^n.
void WheelSignals::take(std::size_t wheel, std::int64_t raw) {
  const int unused = 64 - signals_[wheel].length;
  const std::uint64_t before = static_cast<std::uint64_t>(last_[wheel].value_or(0));
  const std::uint64_t difference = (static_cast<std::uint64_t>(raw) - before) << unused;
  const auto moved = static_cast<std::uint64_t>(static_cast<std::int64_t>(difference) >> unused);
  unwrapped_[wheel] = static_cast<std::int64_t>(static_cast<std::uint64_t>(unwrapped_[wheel]) + moved);
  last_[wheel] = raw;
}

std::vector<std::uint32_t> WheelSignals::ids() const {
  std::vector<std::uint32_t> ids;
  for (const CanSignal& signal : signals_) ids.push_back(signal.id | (signal.extended ? 0x8000'0000u : 0u));
  return ids;
}

}  // namespace curbstone::encoder::signals
