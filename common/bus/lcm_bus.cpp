#include "common/bus/lcm_bus.hpp"

#include <fmt/format.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/bus/message_queue.hpp"
#include "common/bus/socket/bus_socket.hpp"
#include "common/bus/socket/receiver_thread.hpp"
#include "common/bus/socket/route_watch.hpp"
#include "common/time/clock.hpp"

namespace curbstone {

namespace {

constexpr std::int64_t kTurn = 100'000;  // us of handling messages, after which timers run

}  // namespace

class LcmBus::Impl {
 public:
  Impl(std::string url, WithoutRoute without_route)
      : url_(effective_bus_url(std::move(url), kDefaultUrl)), threaded_(url_.starts_with("udpm")) {
    if (!threaded_) {
      if (!url_.starts_with("memq://") && !url_.starts_with("file://"))
        cannot_open("it is no URL of a bus");  // LCM has others, and aborts where it cannot connect to one
      open_now();
      return;
    }
    const auto address = parse_bus_url(url_);
    if (!address) cannot_open("it is no URL of a multicast bus");
    address_ = *address;
    const auto error = route_error(address_);  // LCM says more, and falsely
    if (error && without_route == WithoutRoute::kThrow) cannot_open(*error);
    wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (!error) {
      open_now();
    } else {
      why_closed_ = *error;
      route_.emplace(address_, wake_fd_);
    }
  }

  ~Impl() {
    route_.reset();
    receiver_.reset();
    if (lcm_ != nullptr) lcm_destroy(lcm_);
    if (wake_fd_ >= 0) close(wake_fd_);
  }

  void publish(const std::string& channel, const void* data, int size) {
    const std::scoped_lock lock(publish_mutex_);
    if (lcm_ == nullptr || lcm_publish(lcm_, channel.c_str(), data, static_cast<unsigned>(size)) != 0)
      publish_failed_.fetch_add(1);
  }

  SubscriptionId subscribe(const std::string& channel, BytesHandler handler, QueueLimit limit) {
    add({channel,
         {},
         [handler = std::move(handler)](const QueuedMessage& m) { handler(m.bytes.data(), m.size()); },
         limit});
    pass_what_is_wanted();
    return subscriptions_.back()->id;
  }

  void unsubscribe(SubscriptionId id) {
    const auto found = std::find_if(subscriptions_.begin(), subscriptions_.end(),
                                    [id](const auto& subscription) { return subscription->id == id; });
    if (found == subscriptions_.end()) return;
    if ((*found)->handle != nullptr) lcm_unsubscribe(lcm_, (*found)->handle);
    {
      const std::scoped_lock lock(queue_mutex_);
      queue_.forget(**found);
      subscriptions_.erase(found);
    }
    pass_what_is_wanted();
  }

  void tap(Tap tap, QueueLimit limit, const std::string& except) {
    add({{},
         except,
         [tap = std::move(tap)](const QueuedMessage& m) { tap(m.channel, m.bytes.data(), m.size(), m.utime); },
         limit});
    has_tap_ = true;
    if (socket_) socket_->pass_all();
  }

  void gather(std::chrono::microseconds time) { gather_ = time; }

  void receive_large(std::vector<std::string> channels) { large_channels_ = std::move(channels); }

  bool handle(std::chrono::milliseconds timeout) {
    if (!threaded_) return lcm_handle_timeout(lcm_, static_cast<int>(timeout.count())) >= 0;
    if (timeout.count() > 0) {
      pollfd waiting{wake_fd_, POLLIN, 0};
      poll(&waiting, 1, static_cast<int>(timeout.count()));
    }
    std::uint64_t ignored = 0;
    (void)!read(wake_fd_, &ignored, sizeof ignored);
    if (lcm_ == nullptr) open_when_routed();
    const std::int64_t turn_ends = steady_clock() + kTurn;
    for (int budget = 1000; budget > 0 && steady_clock() < turn_ends; --budget) {
      QueuedMessage message;
      {
        const std::scoped_lock lock(queue_mutex_);
        if (queue_.empty()) return true;
        message = queue_.pop();
      }
      call(message);
    }
    wake();
    return true;
  }

  [[nodiscard]] int fd() const { return threaded_ ? wake_fd_ : lcm_get_fileno(lcm_); }

  [[nodiscard]] Counters counters() const {
    Counters all = counters_;
    all.set("dropped.queue", queue_drops_.load());
    if (socket_) all.set("dropped.kernel", socket_->dropped());
    if (has_tap_ && socket_) all.set("refused.datagram", socket_->refused());
    if (!large_channels_.empty() && socket_) {
      all.set("refused.fragment", socket_->refused_fragments());
      all.set("dropped.large", socket_->dropped_large());
    }
    if (const auto failed = publish_failed_.load(); failed > 0) all.set("faults.publish", failed);
    return all;
  }
  void count(std::string_view name) { counters_.add(name); }

  [[nodiscard]] const std::string& url() const { return url_; }
  [[nodiscard]] std::optional<std::string> fault() const {
    if (why_closed_.empty()) return std::nullopt;
    return fmt::format(
        "the bus {} is not open: {}: it opens as soon as multicast is routed (ip link set lo up; "
        "ip route replace {}/32 dev lo)",
        url_, why_closed_, address_.group);
  }

 private:
  struct Subscription : BusSubscription {
    Impl* bus = nullptr;
    lcm_subscription_t* handle = nullptr;  // only without a socket of our own
  };

  [[noreturn]] void cannot_open(const std::string& why) const {
    throw std::runtime_error(fmt::format(
        "cannot open the bus {}: {}: check the URL ({} is usual), and that multicast is routed (ip link set "
        "lo up; ip route add 224.0.0.0/4 dev lo)",
        url_, why, kDefaultUrl));
  }

  void open_now() {
    try {
      open();
    } catch (const std::runtime_error& error) {
      cannot_open(error.what());
    }
  }

  /// Throws std::runtime_error with the reason.
  void open() {
    lcm_ = lcm_create(url_.c_str());
    if (lcm_ == nullptr) throw std::runtime_error("LCM refuses it");
    if (threaded_ && !subscriptions_.empty()) listen();
  }

  /// Called when route_ has found one. It may be gone again.
  void open_when_routed() {
    if (route_error(address_)) return;
    try {
      open();
      route_.reset();
      why_closed_.clear();
    } catch (const std::runtime_error& error) {
      why_closed_ = error.what();
      if (lcm_ != nullptr) lcm_destroy(std::exchange(lcm_, nullptr));
    }
  }

  void listen() {
    socket_.emplace(address_, large_channels_);
    if (has_tap_) socket_->pass_all();
    pass_what_is_wanted();
    receiver_.emplace(*socket_, gather_, [this] { return receive_some(); });
  }

  void add(BusSubscription wanted) {
    wanted.id = ++last_id_;
    {
      const std::scoped_lock lock(queue_mutex_);
      subscriptions_.push_back(std::make_unique<Subscription>(Subscription{std::move(wanted), this}));
    }
    if (!threaded_) return subscribe_to_lcm(*subscriptions_.back());
    if (lcm_ == nullptr || socket_) return;
    try {
      listen();
    } catch (const std::runtime_error& error) {
      cannot_open(error.what());
    }
  }

  void pass_what_is_wanted() {
    if (!socket_ || has_tap_) return;
    std::vector<std::string> channels;
    for (const auto& subscription : subscriptions_) channels.push_back(subscription->channel);
    socket_->pass_only(channels);
  }

  /// Buses other than multicast (memq, files) use LCM's receiver.
  void subscribe_to_lcm(Subscription& subscription) {
    std::string pattern = subscription.except.empty() ? ".*" : "(?!" + subscription.except + "$).*";
    // Channel names are exact here and patterns in LCM: quote every character that is not a word character.
    if (!subscription.channel.empty()) {
      pattern.clear();
      for (const char c : subscription.channel) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') pattern += '\\';
        pattern += c;
      }
    }
    lcm_subscription_t* handle = lcm_subscribe(lcm_, pattern.c_str(), &Impl::on_message, &subscription);
    if (handle == nullptr) throw std::runtime_error(fmt::format("cannot subscribe to {}", pattern));
    lcm_subscription_set_queue_capacity(handle, 0);
    subscription.handle = handle;
  }

  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* user) {
    auto& subscription = *static_cast<Subscription*>(user);
    const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
    subscription.bus->call({&subscription, channel, buffer->recv_utime, {bytes, bytes + buffer->data_size}});
  }

  void call(const QueuedMessage& message) {
    try {
      message.subscription->handler(message);
    } catch (const std::exception&) {
      counters_.add("faults.handler");
    }
  }

  /// Wakes the handling thread once for all of them; while messages wait, it has been woken already. Returns whether
  /// more may have arrived.
  bool receive_some() {
    bool more = false, is_news = false;
    {
      const std::scoped_lock lock(queue_mutex_);
      const bool was_empty = queue_.empty();
      more = socket_->receive([this](const BusSocket::Message& message) { arrived(message); });
      is_news = was_empty && !queue_.empty();
    }
    if (is_news) wake();
    return more;
  }

  void arrived(const BusSocket::Message& message) {
    for (const auto& subscription : subscriptions_) {
      if (!subscription->wants(message.channel)) continue;
      queue_drops_.fetch_add(queue_.push({subscription.get(),
                                          std::string(message.channel),
                                          message.utime,
                                          {message.bytes.begin(), message.bytes.end()}}));
    }
  }

  void wake() const {
    const std::uint64_t one = 1;
    (void)!write(wake_fd_, &one, sizeof one);
  }

  std::string url_;
  bool threaded_;
  BusAddress address_;
  lcm_t* lcm_ = nullptr;
  int wake_fd_ = -1;
  mutable std::optional<BusSocket> socket_;
  std::vector<std::string> large_channels_;
  std::chrono::microseconds gather_{0};
  bool has_tap_ = false;
  SubscriptionId last_id_ = 0;
  std::mutex queue_mutex_;  // guards the two members below
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  MessageQueue queue_;
  std::mutex publish_mutex_;
  std::atomic<std::int64_t> queue_drops_ = 0;
  std::atomic<std::int64_t> publish_failed_ = 0;
  Counters counters_;
  std::string why_closed_;  // empty: the bus is open
  std::optional<RouteWatch> route_;
  std::optional<ReceiverThread> receiver_;
};

LcmBus::LcmBus(std::string url, WithoutRoute without_route)
    : impl_(std::make_unique<Impl>(std::move(url), without_route)) {}
LcmBus::~LcmBus() = default;

bool LcmBus::handle(std::chrono::milliseconds timeout) {
  return impl_->handle(timeout);
}
std::optional<std::string> LcmBus::fault() const {
  return impl_->fault();
}
int LcmBus::fd() const {
  return impl_->fd();
}
Counters LcmBus::counters() const {
  return impl_->counters();
}
void LcmBus::count(std::string_view name) {
  impl_->count(name);
}
const std::string& LcmBus::url() const {
  return impl_->url();
}
void LcmBus::publish_bytes(const std::string& channel, const void* data, int size) {
  impl_->publish(channel, data, size);
}
void LcmBus::tap(Tap tap, QueueLimit limit, const std::string& except) {
  impl_->tap(std::move(tap), limit, except);
}
void LcmBus::receive_large(std::vector<std::string> channels) {
  impl_->receive_large(std::move(channels));
}
void LcmBus::gather(std::chrono::microseconds time) {
  impl_->gather(time);
}
SubscriptionId LcmBus::subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit limit) {
  return impl_->subscribe(channel, std::move(handler), limit);
}
void LcmBus::unsubscribe(SubscriptionId id) {
  impl_->unsubscribe(id);
}

}  // namespace curbstone
