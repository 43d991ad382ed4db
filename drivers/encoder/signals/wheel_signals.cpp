#include "drivers/encoder/signals/wheel_signals.hpp"

namespace curbstone::encoder::signals {

std::optional<WheelSignals::Values> WheelSignals::on_frame(const can::CanFrame& frame) {
  bool ours = false;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!signals_[i].is_in(frame)) continue;
    ours = true;
    const auto raw = signals_[i].raw(frame);
    if (!raw) {
      counters_.add("refused.length");
      return {};
    }
    take(i, *raw);
  }
  if (!ours) counters_.add("ignored.frames");
  if (!ours || !fresh_[0] || !fresh_[1]) return {};
  fresh_ = {};
  Values values;
  for (std::size_t i = 0; i < 2; ++i) {
    values.counts[i] = static_cast<std::int32_t>(static_cast<std::uint64_t>(unwrapped_[i]));
    values.values[i] = signals_[i].value(*last_[i]);
  }
  return values;
}

/// The shortest way round: a counter of n bits wraps at 2^n.
void WheelSignals::take(std::size_t wheel, std::int64_t raw) {
  const int unused = 64 - signals_[wheel].length;
  const std::uint64_t before = static_cast<std::uint64_t>(last_[wheel].value_or(0));
  const std::uint64_t difference = (static_cast<std::uint64_t>(raw) - before) << unused;
  const auto moved = static_cast<std::uint64_t>(static_cast<std::int64_t>(difference) >> unused);
  unwrapped_[wheel] = static_cast<std::int64_t>(static_cast<std::uint64_t>(unwrapped_[wheel]) + moved);
  last_[wheel] = raw;
  if (fresh_[wheel]) counters_.add("lost.halves");
  fresh_[wheel] = true;
}

std::vector<std::uint32_t> WheelSignals::ids() const {
  std::vector<std::uint32_t> ids;
  for (const CanSignal& signal : signals_) ids.push_back(signal.id | (signal.extended ? 0x8000'0000u : 0u));
  return ids;
}

}  // namespace curbstone::encoder::signals
