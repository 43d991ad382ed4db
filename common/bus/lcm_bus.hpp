#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace curbstone {

/// The bus over LCM: `udpm://`, `memq://`, `file://`.
///
/// Over `udpm://` LCM sends, and this class's receiver thread moves messages from the socket into bounded queues
/// (BusSocket explains why). The counters report losses: `dropped.queue` (handled too slowly) and `dropped.kernel`
/// (this socket's buffer full). `refused.datagram` counts datagrams that were not whole messages; it is reported only
/// while the bus is tapped. The kernel discards messages on channels without a subscriber in this process, unless the
/// bus is tapped. Handlers run in the thread that calls handle(), in order of arrival. All public functions are for
/// that one thread.
class LcmBus final : public Publisher, public Subscriber, public Tappable {
 public:
  /// What to do while the host has no route to the bus.
  enum class WithoutRoute {
    kThrow,
    kWait,  ///< nothing is sent or received until there is one; fault() says so
  };
  /// An empty URL means $LCM_DEFAULT_URL, else kDefaultUrl. Throws std::runtime_error with the URL and what to check.
  explicit LcmBus(std::string url = {}, WithoutRoute without_route = WithoutRoute::kThrow);
  ~LcmBus() override;
  LcmBus(const LcmBus&) = delete;
  LcmBus& operator=(const LcmBus&) = delete;

  /// Handles the messages that have arrived; waits at most `timeout` for the first one. Under overload it handles only
  /// a part, for 0.1 s plus one message, so that timers run; fd() then stays readable. Returns false at the end of a
  /// `file://` log.
  bool handle(std::chrono::milliseconds timeout);

  /// `tap` is called from the thread that handles the bus, with the time (us since the Unix epoch) at which the kernel
  /// received the message.
  void tap(Tap tap, QueueLimit limit, const std::string& except = "") override;

  /// On these channels a tap also receives messages of more than 64 kB, up to 16 MB, as other programs send them: see
  /// FragmentAssembler. `refused.fragment` and `dropped.large` count fragments and messages that did not become whole.
  /// Call it before the first subscription. Only UDP multicast needs this; other buses have no such limit.
  void receive_large(std::vector<std::string> channels);
  /// After messages have come, those that follow within this time are taken together: each that comes alone wakes two
  /// threads, and its sender pays for waking them. The first after a pause does not wait. To be called before the first
  /// subscription; less than a second. 0, the default: each as it comes.
  void gather(std::chrono::microseconds time);

  /// Why the bus is not open yet, in words; nothing once it is.
  [[nodiscard]] std::optional<std::string> fault() const;

  /// For poll(): readable when handle() has work. Call handle(0) then.
  [[nodiscard]] int fd() const;

  void unsubscribe(SubscriptionId id) override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] const std::string& url() const;

  /// ttl=0 keeps messages on this host. The large receive buffer holds bursts; the kernel caps it at net.core.rmem_max.
  static constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";

 protected:
  void count(std::string_view name) override;
  void publish_bytes(const std::string& channel, const void* data, int size) override;
  SubscriptionId subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit limit) override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace curbstone
