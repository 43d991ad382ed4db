#include "common/log/message_order.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

namespace curbstone {
namespace {

constexpr std::int64_t kLatest = std::int64_t{1} << 60;  // us: far from an overflow
constexpr std::int64_t kSettled = 1'000'000;             // us, until a channel's latency is known
constexpr std::int64_t kRising = 8;                      // events over which a channel's least latency is
constexpr std::int64_t kFading = 1024;                   // learned and forgotten: one damaged stamp is neither

}  // namespace

void MessageOrder::push(LogEvent event) {
  advance(event.log_utime);
  const std::int64_t time = std::clamp(message_time(event), std::int64_t{0}, kLatest);
  const std::int64_t key = key_of(event.channel, time);
  waiting_.push({key, sequence_++, elapsed_, key + step_of_most(), std::move(event)});
}

std::optional<LogEvent> MessageOrder::pop() {
  if (waiting_.empty()) return std::nullopt;
  const bool may_be_preceded = waiting_.top().elapsed + window_us_ > elapsed_ && waiting_.size() <= kMaxWaiting;
  return may_be_preceded ? std::nullopt : pop_rest();
}

std::optional<LogEvent> MessageOrder::pop_rest() {
  if (waiting_.empty()) return std::nullopt;
  LogEvent event = waiting_.top().event;
  time_ = waiting_.top().time;
  waiting_.pop();
  return event;
}

/// us: the time without the steps of the channel's clock, and no less than that of its event before.
std::int64_t MessageOrder::key_of(const std::string& name, std::int64_t time) {
  const std::int64_t ahead = time - elapsed_;
  const auto found = channels_.find(name);
  if (found == channels_.end()) {
    const std::int64_t step = first_step(ahead);
    channels_.emplace(name, Channel{elapsed_, time, step, time - step, ahead - step});
    return time - step;
  }
  Channel& channel = found->second;
  const bool is_back = time < std::exchange(channel.last, time) - window_us_;
  const bool is_ahead = ahead - channel.step > channel.ahead + window_us_ && elapsed_ - channel.since > kSettled;
  if (is_back || is_ahead) channel.step = shared_step(ahead - channel.ahead);
  const std::int64_t without_step = ahead - channel.step;
  channel.ahead += (without_step - channel.ahead) / (without_step > channel.ahead ? kRising : kFading);
  return channel.key = std::max(channel.key, time - channel.step);
}

/// A channel that begins in another clock than the others is sorted as if it were in theirs.
std::int64_t MessageOrder::first_step(std::int64_t ahead) const {
  if (channels_.empty()) return 0;
  const std::int64_t step = shared_step(ahead - channels_.begin()->second.ahead);
  return std::abs(step) > kSettled ? step : 0;
}

/// The step of a channel whose clock was set by the same, or else this one.
std::int64_t MessageOrder::shared_step(std::int64_t step) const {
  std::int64_t nearest = 0;
  for (const auto& [name, channel] : channels_) {
    if (std::abs(step - channel.step) < std::abs(step - nearest)) nearest = channel.step;
  }
  return std::abs(step - nearest) <= window_us_ ? nearest : step;
}

/// us: the step ahead that more than half of the channels have made; 0 if there is none.
std::int64_t MessageOrder::step_of_most() const {
  std::vector<std::int64_t> steps;
  for (const auto& [name, channel] : channels_) steps.push_back(channel.step);
  const auto middle = steps.begin() + (std::ssize(steps) - 1) / 2;
  std::nth_element(steps.begin(), middle, steps.end());
  return std::max(*middle, std::int64_t{0});
}

/// Advances the log's time. A forward step counts for at most the window. After a step back by more than the window
/// the time continues from there.
void MessageOrder::advance(std::int64_t log_utime) {
  if (sequence_ == 0) newest_ = log_utime;
  const std::int64_t step = log_utime - newest_;
  if (step < 0 && step >= -window_us_) return;
  elapsed_ += std::clamp(step, std::int64_t{0}, window_us_);
  newest_ = log_utime;
}

}  // namespace curbstone
