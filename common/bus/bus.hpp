#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/bus/decode.hpp"

namespace curbstone {

/// The sending side of the bus. It is all that a node knows of the bus, so a node runs the same over UDP multicast,
/// `memq://`, a log, or inside `curbstone replay`. One thread.
class Publisher {
 public:
  virtual ~Publisher() = default;

  /// Encodes and sends one message. Called from the node's thread. Never throws: a message that cannot be sent is
  /// counted.
  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    const int size = message.getEncodedSize();
    buffer_.resize(static_cast<std::size_t>(size));
    if (message.encode(buffer_.data(), 0, size) == size) publish_bytes(channel, buffer_.data(), size);
  }

 protected:
  virtual void publish_bytes(const std::string& channel, const void* data, int size) = 0;

 private:
  std::vector<std::uint8_t> buffer_;
};

/// Bounds of a subscription's queue, for messages that come faster than they are handled.
struct QueueLimit {
  int capacity = 1000;                       ///< messages; when one more comes, the oldest is dropped and counted
  std::size_t bytes = std::size_t{1} << 26;  ///< the same bound for all queued messages together
};

/// A bus on which every message can be heard, whatever its channel and type: for recording.
class Tappable {
 public:
  /// `utime`: arrival time of the message, us; 0 on a bus without times.
  using Tap = std::function<void(const std::string& channel, const void* data, int size, std::int64_t utime)>;

  virtual ~Tappable() = default;

  /// Calls `tap` for every message from this call on, also for those that this process sends. Messages of the channel
  /// `except` are left out. At most one tap.
  virtual void tap(Tap tap, QueueLimit limit, const std::string& except) = 0;
};

/// Names a subscription of a Subscriber, for unsubscribe().
using SubscriptionId = std::uint32_t;

/// The receiving side of the bus. Channels are exact names, not patterns. One thread.
class Subscriber {
 public:
  using BytesHandler = std::function<void(const void* data, int size)>;

  virtual ~Subscriber() = default;

  /// `handler(const Message&)` is called from the thread that handles the bus. A message that does not decode is
  /// counted as `refused.undecodable`. A handler that throws is counted as `faults.handler`, because an exception
  /// cannot pass through LCM's C code.
  template <class Message, class Handler>
  SubscriptionId subscribe(const std::string& channel, Handler handler, QueueLimit limit = {}) {
    return subscribe_bytes(
        channel,
        [this, handler = std::move(handler)](const void* data, int size) {
          Message message{};
          if (!decode(data, size, message)) {
            count("refused.undecodable");
            return;
          }
          handler(message);
        },
        limit);
  }

  /// Ends a subscription: its handler is not called any more, also not for messages that have arrived. Not to be called
  /// from a handler. An unknown id is ignored.
  virtual void unsubscribe(SubscriptionId id) = 0;

  /// Counts of received messages that were lost or refused.
  [[nodiscard]] virtual Counters counters() const = 0;

 protected:
  virtual void count(std::string_view name) = 0;
  virtual SubscriptionId subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit limit) = 0;
};

}  // namespace curbstone
