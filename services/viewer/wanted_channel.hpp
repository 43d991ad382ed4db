#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "common/bus/bus.hpp"

namespace curbstone::viewer {

/// A channel that loads the bus and this process, so it is subscribed to only while somebody wants it, and kLinger
/// longer: a page that is reloaded finds it. One thread.
template <class Message>
class WantedChannel {
 public:
  static constexpr std::int64_t kLinger = 5'000'000;  ///< us

  /// `take` is called only while the channel is wanted. What it refers to must outlive the bus or this.
  WantedChannel(std::string channel, std::function<void(const Message&)> take)
      : channel_(std::move(channel)), take_(std::move(take)) {}
  WantedChannel(const WantedChannel&) = delete;
  WantedChannel& operator=(const WantedChannel&) = delete;

  /// Call it regularly, but not from a handler of the bus. `now`: us; `bus`: null before it is connected.
  void tick(std::int64_t now, bool is_wanted, Subscriber* bus) {
    is_wanted_ = is_wanted;
    if (is_wanted) wanted_ = now;
    if (bus == nullptr) return;
    if (is_wanted && !subscription_) {
      subscription_ = bus->subscribe<Message>(channel_, [this](const Message& message) {
        if (is_wanted_) take_(message);
      });
    }
    const bool is_over = !is_wanted && (now < wanted_ || now - wanted_ >= kLinger);
    if (subscription_ && is_over) bus->unsubscribe(*std::exchange(subscription_, std::nullopt));
  }

 private:
  std::string channel_;
  std::function<void(const Message&)> take_;
  bool is_wanted_ = false;
  std::int64_t wanted_ = 0;  // us, the last time
  std::optional<SubscriptionId> subscription_;
};

}  // namespace curbstone::viewer
