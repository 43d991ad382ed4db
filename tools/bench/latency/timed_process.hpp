#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/node.hpp"

namespace curbstone::bench::latency {

/// A message in transit or delivered.
struct TimedMessage {
  std::int64_t at = 0;  ///< us, time of sending
  std::string channel;
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;

  /// False if the bytes are not a valid `Message`.
  template <class Message>
  [[nodiscard]] bool decode(Message& out) const {
    return out.decode(bytes->data(), 0, static_cast<int>(bytes->size())) >= 0;
  }
};

/// Runs a node as a simulated process with its own clock, which advances by the CPU time of the node's work. So its
/// messages are sent as late as they would be live, however busy this machine is.
class TimedProcess final : public Publisher, public Subscriber {
 public:
  using Send = std::function<void(TimedMessage)>;
  /// `phase`: us; ticks follow every 20 ms from there.
  TimedProcess(std::int64_t phase, Send send) : tick_(phase), send_(std::move(send)) {}
  /// Takes the node, which must have been constructed with this object as its Publisher.
  void run(std::unique_ptr<Node> node);
  /// Sets the clock. Call it once, before anything else.
  void start(std::int64_t now) { tick_ += now; }

  /// Queues a message that arrives now or later.
  void deliver(const TimedMessage& message);
  /// The start time of its next work item, us.
  [[nodiscard]] std::int64_t next() const;
  /// Executes that item (one message, one tick, or deferred work), not before `at` us. Returns its end time.
  std::int64_t work(std::int64_t at);

  [[nodiscard]] const Node& node() const { return *node_; }
  [[nodiscard]] std::int64_t cpu_us() const { return cpu_; }
  /// CPU time of the longest work item since the last call, us.
  std::int64_t take_longest_us() { return std::exchange(longest_, 0); }
  void unsubscribe(SubscriptionId id) override;
  [[nodiscard]] Counters counters() const override { return counters_; }

 protected:
  void publish_bytes(const std::string& channel, const void* data, int size) override;
  void count(std::string_view name) override { counters_.add(name); }
  SubscriptionId subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit limit) override;

 private:
  [[nodiscard]] std::int64_t spent() const;
  std::int64_t tick_;
  Send send_;
  std::unique_ptr<Node> node_;
  struct Subscription {
    SubscriptionId id = 0;
    BytesHandler handler;
  };
  std::map<std::string, Subscription, std::less<>> subscriptions_;  // by channel, one each
  SubscriptionId last_id_ = 0;
  std::multimap<std::int64_t, TimedMessage> inbox_;  // equal times keep their order
  std::int64_t free_ = 0;                            // us, end of the present work item
  bool may_idle_ = false;                            // the node may have deferred work for idle times
  std::int64_t begun_ = 0;                           // us, start of the present work item
  double cpu_begun_ = 0;
  std::int64_t cpu_ = 0;
  std::int64_t longest_ = 0;
  Counters counters_;
};

}  // namespace curbstone::bench::latency
