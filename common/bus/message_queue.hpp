#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"

namespace curbstone {

struct BusSubscription;

/// A message that waits for its subscription's handler.
struct QueuedMessage {
  BusSubscription* subscription = nullptr;
  std::string channel;
  std::int64_t utime = 0;  ///< us, when the kernel received it
  std::vector<std::uint8_t> bytes;
  [[nodiscard]] int size() const { return static_cast<int>(bytes.size()); }
};

struct BusSubscription {
  std::string channel;  ///< empty: a tap
  std::string except;   ///< of a tap
  std::function<void(const QueuedMessage&)> handler;
  QueueLimit limit;
  SubscriptionId id = 0;
  std::size_t queued = 0;  ///< messages of it in the queue
  std::size_t queued_bytes = 0;

  [[nodiscard]] bool wants(std::string_view name) const { return channel.empty() ? name != except : name == channel; }
  [[nodiscard]] bool is_full_for(std::size_t size) const {
    return queued > 0 &&
           (queued >= static_cast<std::size_t>(std::max(limit.capacity, 1)) || queued_bytes + size > limit.bytes);
  }
};

/// The messages of all subscriptions in their order of arrival, of each as many as its limit allows. One thread.
class MessageQueue {
 public:
  /// Drops the oldest messages of the subscription if it is full. Returns how many.
  int push(QueuedMessage message) {
    BusSubscription& subscription = *message.subscription;
    int dropped = 0;
    for (; subscription.is_full_for(message.bytes.size()); ++dropped) {
      const auto oldest = std::find_if(queue_.begin(), queue_.end(),
                                       [&](const QueuedMessage& m) { return m.subscription == &subscription; });
      leaves(*oldest);
      queue_.erase(oldest);
    }
    ++subscription.queued;
    subscription.queued_bytes += message.bytes.size();
    queue_.push_back(std::move(message));
    return dropped;
  }
  /// The oldest message; the queue is not empty.
  [[nodiscard]] QueuedMessage pop() {
    QueuedMessage message = std::move(queue_.front());
    queue_.pop_front();
    leaves(message);
    return message;
  }
  void forget(const BusSubscription& subscription) {
    std::erase_if(queue_, [&](const QueuedMessage& m) { return m.subscription == &subscription; });
  }
  [[nodiscard]] bool empty() const { return queue_.empty(); }

 private:
  static void leaves(const QueuedMessage& message) {
    --message.subscription->queued;
    message.subscription->queued_bytes -= message.bytes.size();
  }
  std::deque<QueuedMessage> queue_;
};

}  // namespace curbstone
