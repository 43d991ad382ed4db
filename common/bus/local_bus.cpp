#include "common/bus/local_bus.hpp"

namespace curbstone {

void LocalBus::inject(const std::string& channel, const void* data, int size) {
  if (tap_ && channel != untapped_) tap_(channel, data, size, 0);
  if (!hears(channel)) return;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  queue_.push_back({channel, {bytes, bytes + size}});
}

void LocalBus::tap(Tap tap, QueueLimit, const std::string& except) {
  tap_ = std::move(tap);
  untapped_ = except;
}

void LocalBus::dispatch() {
  while (!queue_.empty()) {
    const Message message = std::move(queue_.front());
    queue_.pop_front();
    const auto heard = subscriptions_.find(message.channel);
    if (heard == subscriptions_.end()) continue;  // unsubscribed since it was published
    for (const Subscription& subscription : heard->second) {
      subscription.handler(message.bytes.data(), static_cast<int>(message.bytes.size()));
    }
  }
}

SubscriptionId LocalBus::subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit) {
  subscriptions_[channel].push_back({++last_id_, std::move(handler)});
  return last_id_;
}

void LocalBus::unsubscribe(SubscriptionId id) {
  for (auto& [channel, all] : subscriptions_) {
    std::erase_if(all, [id](const Subscription& subscription) { return subscription.id == id; });
  }
  std::erase_if(subscriptions_, [](const auto& entry) { return entry.second.empty(); });
}

}  // namespace curbstone
