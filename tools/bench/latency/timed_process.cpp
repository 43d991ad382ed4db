#include "tools/bench/latency/timed_process.hpp"

#include <ctime>

namespace curbstone::bench::latency {

namespace {

constexpr std::int64_t kTick = 20'000;  // us

double cpu_us_of_thread() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e6 + static_cast<double>(t.tv_nsec) * 1e-3;
}

}  // namespace

void TimedProcess::run(std::unique_ptr<Node> node) {
  node_ = std::move(node);
  node_->connect(*this);
}

void TimedProcess::deliver(const TimedMessage& message) {
  if (subscriptions_.contains(message.channel)) inbox_.emplace(message.at, message);
}

std::int64_t TimedProcess::next() const {
  if (may_idle_) return free_;
  const std::int64_t due = inbox_.empty() ? tick_ : std::min(tick_, inbox_.begin()->first);
  return std::max(due, free_);
}

std::int64_t TimedProcess::work(std::int64_t at) {
  begun_ = std::max(at, next());
  cpu_begun_ = cpu_us_of_thread();
  const std::int64_t due = inbox_.empty() ? tick_ : std::min(tick_, inbox_.begin()->first);
  if (due > begun_) {
    may_idle_ = node_->idle(begun_);
  } else if (may_idle_ = true; !inbox_.empty() && inbox_.begin()->first < tick_) {
    const TimedMessage message = std::move(inbox_.begin()->second);
    inbox_.erase(inbox_.begin());
    subscriptions_.find(message.channel)
        ->second.handler(message.bytes->data(), static_cast<int>(message.bytes->size()));
    const std::int64_t now = begun_ + spent();
    if (inbox_.empty() || inbox_.begin()->first > now) node_->caught_up(now);
  } else {
    node_->tick(begun_);
    tick_ += kTick;
    if (tick_ < begun_) tick_ = begun_ + kTick - (begun_ - tick_) % kTick;  // missed ticks are not made up
  }
  const std::int64_t took = spent();
  cpu_ += took;
  longest_ = std::max(longest_, took);
  free_ = begun_ + took;
  return free_;
}

/// CPU time of the present work item so far, us.
std::int64_t TimedProcess::spent() const {
  return static_cast<std::int64_t>(cpu_us_of_thread() - cpu_begun_);
}

void TimedProcess::publish_bytes(const std::string& channel, const void* data, int size) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  send_({begun_ + spent(), channel, std::make_shared<std::vector<std::uint8_t>>(bytes, bytes + size)});
}

SubscriptionId TimedProcess::subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit) {
  subscriptions_[channel] = {++last_id_, std::move(handler)};
  return last_id_;
}

void TimedProcess::unsubscribe(SubscriptionId id) {
  std::erase_if(subscriptions_, [id](const auto& entry) { return entry.second.id == id; });
}

}  // namespace curbstone::bench::latency
