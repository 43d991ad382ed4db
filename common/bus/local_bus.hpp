#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace curbstone {

/// A bus inside one process and one thread: messages are delivered in the order in which they were published, none is
/// lost, and nothing depends on the clock. `curbstone replay` and the node tests run on it.
class LocalBus final : public Publisher, public Subscriber, public Tappable {
 public:
  /// Publishes encoded bytes, as read from a log.
  void inject(const std::string& channel, const void* data, int size);
  /// Whether the channel has a subscriber.
  [[nodiscard]] bool hears(const std::string& channel) const { return subscriptions_.contains(channel); }
  /// Delivers until the queue is empty, including messages that the handlers publish.
  void dispatch();
  /// The tap sees a message when it is published, before its subscribers do.
  void tap(Tap tap, QueueLimit limit = {}, const std::string& except = "") override;

  void unsubscribe(SubscriptionId id) override;
  [[nodiscard]] Counters counters() const override { return counters_; }

 protected:
  void count(std::string_view name) override { counters_.add(name); }
  void publish_bytes(const std::string& channel, const void* data, int size) override { inject(channel, data, size); }
  SubscriptionId subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit limit) override;

 private:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };
  struct Subscription {
    SubscriptionId id;
    BytesHandler handler;
  };
  std::map<std::string, std::vector<Subscription>, std::less<>> subscriptions_;  // by channel; none is empty
  SubscriptionId last_id_ = 0;
  std::deque<Message> queue_;
  Tap tap_;
  std::string untapped_;
  Counters counters_;
};

}  // namespace curbstone
