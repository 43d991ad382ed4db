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

/// A message on its way, or arrived.
struct TimedMessage {
  std::int64_t at = 0;  ///< us, when it was sent
  std::string channel;
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;

  /// False if the bytes are no `Message`.
  template <class Message>
  [[nodiscard]] bool decode(Message& out) const {
    return out.decode(bytes->data(), 0, static_cast<int>(bytes->size())) >= 0;
  }
};

/// A node as the process that it is on the vehicle, but on a clock of its own, which goes on by the CPU time that the
/// node's work takes: what it says is said as late as it would be live, however busy this machine is meanwhile.
class TimedProcess final : public Publisher, public Subscriber {
 public:
  using Send = std::function<void(TimedMessage)>;
  /// `phase` us: its ticks are every 20 ms from there.
  TimedProcess(std::int64_t phase, Send send) : tick_(phase), send_(std::move(send)) {}
  /// Takes the node, which must have been made with this as its Publisher.
  void run(std::unique_ptr<Node> node);
  /// Sets the clock, once, before anything else happens.
  void start(std::int64_t now) { tick_ += now; }

  /// A message that has come, or will have come at its time.
  void deliver(const TimedMessage& message);
  /// When it begins its next piece of work, us.
  [[nodiscard]] std::int64_t next() const;
  /// Does that: one message, one tick or what may wait, not before `at` us. Returns when it is done.
  std::int64_t work(std::int64_t at);

  [[nodiscard]] const Node& node() const { return *node_; }
  [[nodiscard]] std::int64_t cpu_us() const { return cpu_; }
  /// CPU time of the longest piece of work since this was asked for last, us.
  std::int64_t take_longest_us() { return std::exchange(longest_, 0); }
  [[nodiscard]] Counters counters() const override { return counters_; }

 protected:
  void publish_bytes(const std::string& channel, const void* data, int size) override;
  void count(std::string_view name) override { counters_.add(name); }
  void subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit limit) override;

 private:
  [[nodiscard]] std::int64_t spent() const;
  std::int64_t tick_;
  Send send_;
  std::unique_ptr<Node> node_;
  std::map<std::string, BytesHandler, std::less<>> handlers_;
  std::multimap<std::int64_t, TimedMessage> inbox_;  // equal times stay in order
  std::int64_t free_ = 0;                            // us, when it has done what it does
  bool may_idle_ = false;                            // the node may have work that waits until there is nothing else
  std::int64_t begun_ = 0;                           // us, the piece of work under way
  double cpu_begun_ = 0;
  std::int64_t cpu_ = 0;
  std::int64_t longest_ = 0;
  Counters counters_;
};

}  // namespace curbstone::bench::latency
