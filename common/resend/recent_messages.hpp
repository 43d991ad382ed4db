#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <curbstone/resend_request_t.hpp>
#include <deque>
#include <string>
#include <utility>

#include "common/bus/bus.hpp"

namespace curbstone {

inline constexpr const char* kResendRequests = "RESEND_REQUEST";

/// The channel on which messages of `channel` are sent again.
[[nodiscard]] inline std::string resent_channel(const std::string& channel) {
  return channel + "_AGAIN";
}

/// Bounds of what is kept.
struct KeepLimits {
  std::int64_t span = 10'000'000;             ///< us, by the stamps of the messages
  std::size_t bytes = std::size_t{64} << 20;  ///< of the kept messages
};

/// The newest messages of a channel, for listeners that lost some of them on the bus. For each message a `Kept` is
/// held, from which the message can be made again. A `Kept` has `utime` (us), bytes(), the memory it takes, and
/// message(), which Publisher::publish() accepts. Answers are paced so that a stock kernel's socket buffer can hold
/// them besides the channel's own messages: at most kAtOnce messages and kBytesAtOnce a tick. One thread.
template <class Kept>
class RecentMessages {
 public:
  static constexpr int kAtOnce = 30;                    ///< messages a tick of 20 ms: twice what a LiDAR sends
  static constexpr std::size_t kBytesAtOnce = 180'000;  ///< a tick
  static constexpr std::size_t kMaxListeners = 8;       ///< listeners answered at a time

  RecentMessages(Publisher& bus, std::string channel, KeepLimits limits = {})
      : bus_(bus), channel_(std::move(channel)), limits_(limits) {}

  /// Keeps a message that was sent on the channel. Messages come in the order of their stamps; one that is out of order
  /// is not kept, and a stamp that jumps back clears what was kept.
  void add(Kept message) {
    if (!make_room(message.utime, message.bytes())) return;
    kept_bytes_ += message.bytes();
    kept_.push_back(std::move(message));
  }

  /// Takes a request for any channel. A requester's newest request replaces its previous one.
  void request(const resend_request_t& message) {
    if (message.channel != channel_) return;
    std::erase_if(wanted_, [&](const Wanted& wanted) { return wanted.requester == message.requester; });
    if (message.after >= message.before || wanted_.size() >= kMaxListeners) return;
    wanted_.push_back({message.requester, message.after, message.before});
    send();
  }
  /// Call every 20 ms: sends a part of the requested messages.
  void tick() {
    messages_left_ = kAtOnce;
    bytes_left_ = kBytesAtOnce;
    send();
  }

  /// Messages that were sent again.
  [[nodiscard]] std::int64_t resent() const { return resent_; }

 protected:
  /// Evicts messages beyond the limits. Returns false if the new message is not to be kept.
  [[nodiscard]] bool make_room(std::int64_t utime, std::size_t bytes) {
    if (utime <= 0 || bytes > limits_.bytes) return false;
    if (!kept_.empty() && utime <= kept_.back().utime) {
      if (kept_.back().utime - utime < limits_.span) return false;
      kept_.clear();  // the clock was set back
      kept_bytes_ = 0;
    }
    while (!kept_.empty() && (kept_bytes_ + bytes > limits_.bytes || utime - kept_.front().utime > limits_.span)) {
      kept_bytes_ -= kept_.front().bytes();
      forgotten_ = std::move(kept_.front());
      kept_.pop_front();
    }
    return true;
  }
  /// The message evicted last: its memory can be reused.
  [[nodiscard]] Kept& forgotten() { return forgotten_; }

 private:
  struct Wanted {
    std::string requester;
    std::int64_t after, before;  // us
  };

  /// Serves the requesters in turn, one message each.
  void send() {
    while (!wanted_.empty()) {
      Wanted wanted = std::move(wanted_.front());
      const auto next = std::upper_bound(kept_.begin(), kept_.end(), wanted.after,
                                         [](std::int64_t after, const Kept& kept) { return after < kept.utime; });
      if (next == kept_.end() || next->utime >= wanted.before) {
        wanted_.pop_front();
        continue;
      }
      if (messages_left_ == 0 || !send(*next)) {
        wanted_.front() = std::move(wanted);
        return;
      }
      wanted_.pop_front();
      wanted.after = next->utime;
      wanted_.push_back(std::move(wanted));
    }
  }
  /// Returns false if the message exceeds the tick's remaining bytes.
  bool send(const Kept& kept) {
    decltype(auto) message = kept.message();
    const auto bytes = static_cast<std::size_t>(message.getEncodedSize());
    if (bytes > bytes_left_ && messages_left_ < kAtOnce) return false;
    bus_.publish(resent_channel(channel_), message);
    ++resent_;
    --messages_left_;
    bytes_left_ -= std::min(bytes_left_, bytes);
    return true;
  }

  Publisher& bus_;
  std::string channel_;
  KeepLimits limits_;
  std::deque<Kept> kept_;
  std::size_t kept_bytes_ = 0;
  Kept forgotten_;
  std::deque<Wanted> wanted_;  // the next requester to serve comes first
  int messages_left_ = kAtOnce;
  std::size_t bytes_left_ = kBytesAtOnce;
  std::int64_t resent_ = 0;
};

}  // namespace curbstone
