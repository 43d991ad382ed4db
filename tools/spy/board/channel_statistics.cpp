#include "tools/spy/board/channel_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::spy::board {

void ChannelStatistics::add(std::int64_t now, std::size_t size, std::optional<std::int64_t> sequence) {
  ++messages_;
  arrivals_.push_back({now, size});
  while (arrivals_.size() > kMaxMessages || now - arrivals_.front().time > kWindow) arrivals_.pop_front();
  if (!sequence) return;
  lost_ = lost_.value_or(0);
  if (sequence_ && *sequence > *sequence_ && *sequence - *sequence_ <= kWholeGap) *lost_ += *sequence - *sequence_ - 1;
  sequence_ = sequence;
}

ChannelRates ChannelStatistics::rates(std::int64_t now) const {
  ChannelRates rates;
  if (arrivals_.empty()) return rates;
  rates.age = now - arrivals_.back().time;
  const auto first = std::ranges::find_if(arrivals_, [&](const Arrival& a) { return now - a.time <= kWindow; });
  const auto count = arrivals_.end() - first;
  if (count < 2) return rates;
  // The rate of a channel that falls silent must decrease: the time since its last message counts once it exceeds an
  // interval.
  const auto span = static_cast<double>(arrivals_.back().time - first->time) * 1e-6;
  const double interval = span / static_cast<double>(count - 1);
  const double whole = std::max(span, span - interval + static_cast<double>(rates.age) * 1e-6);
  if (whole <= 0) return rates;
  double bytes = 0, squares = 0;
  for (auto arrival = first + 1; arrival != arrivals_.end(); ++arrival) {
    bytes += static_cast<double>(arrival->size);
    const double deviation = static_cast<double>(arrival->time - (arrival - 1)->time) * 1e-6 - interval;
    squares += deviation * deviation;
  }
  rates.rate = static_cast<double>(count - 1) / whole;
  rates.bandwidth = bytes / whole;
  if (count > 2) rates.jitter = std::sqrt(squares / static_cast<double>(count - 1));
  return rates;
}

}  // namespace curbstone::spy::board
