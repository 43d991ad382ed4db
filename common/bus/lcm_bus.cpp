#include "common/bus/lcm_bus.hpp"

#include <fmt/format.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/bus_socket.hpp"
#include "common/time/clock.hpp"

namespace curbstone {

namespace {

constexpr std::int64_t kTurn = 100'000;  // us of handling messages, after which timers run

std::string effective_url(std::string url) {
  if (!url.empty()) return url;
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");
  return from_environment != nullptr && *from_environment != '\0' ? from_environment : LcmBus::kDefaultUrl;
}

}  // namespace

class LcmBus::Impl {
 public:
  explicit Impl(std::string url) : url_(effective_url(std::move(url))), threaded_(url_.starts_with("udpm")) {
    if (threaded_) {
      const auto address = parse_bus_url(url_);
      if (!address) cannot_open("it is no URL of a multicast bus");
      address_ = *address;
      if (const auto error = route_error(address_)) cannot_open(*error);  // LCM says more, and falsely
    } else if (!url_.starts_with("memq://") && !url_.starts_with("file://")) {
      cannot_open("it is no URL of a bus");  // LCM has others, and aborts where it cannot connect to one
    }
    lcm_ = lcm_create(url_.c_str());
    if (lcm_ == nullptr) cannot_open("LCM refuses it");
    if (threaded_) {
      wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
      stop_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    }
  }

  ~Impl() {
    if (receiver_.joinable()) {
      const std::uint64_t one = 1;
      (void)!write(stop_fd_, &one, sizeof one);
      receiver_.join();
    }
    lcm_destroy(lcm_);
    if (wake_fd_ >= 0) close(wake_fd_);
    if (stop_fd_ >= 0) close(stop_fd_);
  }

  void publish(const std::string& channel, const void* data, int size) {
    const std::scoped_lock lock(publish_mutex_);
    if (lcm_publish(lcm_, channel.c_str(), data, static_cast<unsigned>(size)) != 0) publish_failed_.fetch_add(1);
  }

  SubscriptionId subscribe(const std::string& channel, BytesHandler handler, QueueLimit limit) {
    add({channel, {}, [handler = std::move(handler)](const Message& m) { handler(m.bytes.data(), m.size()); }, limit});
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
      std::erase_if(queue_, [&](const Message& waiting) { return waiting.subscription == found->get(); });
      subscriptions_.erase(found);
    }
    pass_what_is_wanted();
  }

  void tap(Tap tap, QueueLimit limit, const std::string& except) {
    add({{},
         except,
         [tap = std::move(tap)](const Message& m) { tap(m.channel, m.bytes.data(), m.size(), m.utime); },
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
    const std::int64_t turn_ends = steady_clock() + kTurn;
    for (int budget = 1000; budget > 0 && steady_clock() < turn_ends; --budget) {
      Message message;
      {
        const std::scoped_lock lock(queue_mutex_);
        if (queue_.empty()) return true;
        message = std::move(queue_.front());
        queue_.pop_front();
        leaves(message);
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

 private:
  struct Subscription;
  struct Message {
    Subscription* subscription = nullptr;
    std::string channel;
    std::int64_t utime = 0;  // us, when the kernel received it
    std::vector<std::uint8_t> bytes;
    [[nodiscard]] int size() const { return static_cast<int>(bytes.size()); }
  };
  struct Subscription {
    std::string channel;  // empty: a tap
    std::string except;   // of a tap
    std::function<void(const Message&)> handler;
    QueueLimit limit;
    std::size_t queued = 0;
    std::size_t queued_bytes = 0;
    Impl* bus = nullptr;
    SubscriptionId id = 0;
    lcm_subscription_t* handle = nullptr;  // only without a socket of our own

    [[nodiscard]] bool wants(std::string_view name) const { return channel.empty() ? name != except : name == channel; }
    [[nodiscard]] bool is_full_for(std::size_t size) const {
      return queued > 0 &&
             (queued >= static_cast<std::size_t>(std::max(limit.capacity, 1)) || queued_bytes + size > limit.bytes);
    }
  };

  [[noreturn]] void cannot_open(const std::string& why) const {
    throw std::runtime_error(fmt::format(
        "cannot open the bus {}: {}: check the URL ({} is usual), and that multicast is routed (ip link set "
        "lo up; ip route add 224.0.0.0/4 dev lo)",
        url_, why, kDefaultUrl));
  }

  void add(Subscription subscription) {
    subscription.bus = this;
    subscription.id = ++last_id_;
    {
      const std::scoped_lock lock(queue_mutex_);
      subscriptions_.push_back(std::make_unique<Subscription>(std::move(subscription)));
    }
    if (!threaded_) return subscribe_to_lcm(*subscriptions_.back());
    if (socket_) return;
    try {
      socket_.emplace(address_, large_channels_);
    } catch (const std::runtime_error& error) {
      cannot_open(error.what());
    }
    receiver_ = std::thread([this] { receive(); });
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

  void call(const Message& message) {
    try {
      message.subscription->handler(message);
    } catch (const std::exception&) {
      counters_.add("faults.handler");
    }
  }

  /// The loop of the receiver thread.
  void receive() {
    pollfd fds[2] = {{socket_->fd(), POLLIN, 0}, {stop_fd_, POLLIN, 0}};
    while (true) {
      if (poll(fds, 2, -1) < 0) continue;
      if (fds[1].revents != 0) return;
      if (receive_some()) continue;
      const timespec gather{0, static_cast<long>(gather_.count()) * 1000};
      if (gather_.count() > 0 && ppoll(&fds[1], 1, &gather, nullptr) > 0) return;
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
      if (subscription->wants(message.channel)) enqueue(*subscription, message);
    }
  }

  /// Adds a message to the queue; drops the oldest ones of the subscription if its queue is full.
  void enqueue(Subscription& subscription, const BusSocket::Message& message) {
    while (subscription.is_full_for(message.bytes.size())) {
      const auto oldest = std::find_if(queue_.begin(), queue_.end(),
                                       [&](const Message& waiting) { return waiting.subscription == &subscription; });
      leaves(*oldest);
      queue_.erase(oldest);
      queue_drops_.fetch_add(1);
    }
    queue_.push_back(
        {&subscription, std::string(message.channel), message.utime, {message.bytes.begin(), message.bytes.end()}});
    ++subscription.queued;
    subscription.queued_bytes += message.bytes.size();
  }

  static void leaves(const Message& message) {
    --message.subscription->queued;
    message.subscription->queued_bytes -= message.bytes.size();
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
  int stop_fd_ = -1;
  mutable std::optional<BusSocket> socket_;
  std::vector<std::string> large_channels_;
  std::chrono::microseconds gather_{0};
  bool has_tap_ = false;
  SubscriptionId last_id_ = 0;
  std::mutex queue_mutex_;  // guards the two members below
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::deque<Message> queue_;
  std::mutex publish_mutex_;
  std::atomic<std::int64_t> queue_drops_ = 0;
  std::atomic<std::int64_t> publish_failed_ = 0;
  Counters counters_;
  std::thread receiver_;
};

LcmBus::LcmBus(std::string url) : impl_(std::make_unique<Impl>(std::move(url))) {}
LcmBus::~LcmBus() = default;

bool LcmBus::handle(std::chrono::milliseconds timeout) {
  return impl_->handle(timeout);
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
