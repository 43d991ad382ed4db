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

/// Where what was sent on `channel` comes again.
[[nodiscard]] inline std::string again(const std::string& channel) {
  return channel + "_AGAIN";
}

/// What is kept at most.
struct KeepLimits {
  std::int64_t span = 10'000'000;             ///< us, by the stamps of the messages
  std::size_t bytes = std::size_t{64} << 20;  ///< of what is kept of them
};

/// The newest messages of a channel, for listeners that lost some on the bus. Of each a `Kept` is held, from which the
/// message can be made again: it has `utime` (us), bytes(), which it takes, and message(), which Publisher::publish()
/// takes. Answers go out at a pace that a stock kernel's socket buffer bears beside the channel itself: kAtOnce
/// messages and kBytesAtOnce a tick. One thread.
template <class Kept>
class RecentMessages {
 public:
  static constexpr int kAtOnce = 30;                    ///< messages a tick: of 20 ms, twice what a LiDAR sends
  static constexpr std::size_t kBytesAtOnce = 180'000;  ///< a tick
  static constexpr std::size_t kMostAsking = 8;         ///< listeners that are answered at a time

  RecentMessages(Publisher& bus, std::string channel, KeepLimits limits = {})
      : bus_(bus), channel_(std::move(channel)), limits_(limits) {}

  /// Of a message that was sent on the channel. They come in the order of their stamps; one that does not is not kept,
  /// and a stamp that jumps back begins anew.
  void add(Kept message) {
    if (!make_room(message.utime, message.bytes())) return;
    kept_bytes_ += message.bytes();
    kept_.push_back(std::move(message));
  }

  /// A request, of any channel. The newest one of a requester replaces the one before.
  void request(const resend_request_t& message) {
    if (message.channel != channel_) return;
    std::erase_if(wanted_, [&](const Wanted& wanted) { return wanted.requester == message.requester; });
    if (message.after >= message.before || wanted_.size() >= kMostAsking) return;
    wanted_.push_back({message.requester, message.after, message.before});
    send();
  }
  /// Each 20 ms: sends a part of what was asked for.
  void tick() {
    messages_left_ = kAtOnce;
    bytes_left_ = kBytesAtOnce;
    send();
  }

  /// Messages that were sent again.
  [[nodiscard]] std::int64_t resent() const { return resent_; }

 protected:
  /// Forgets what is too old or too much. False for a message that is not to be kept.
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
  /// The last one: its memory does for another.
  [[nodiscard]] Kept& forgotten() { return forgotten_; }

 private:
  struct Wanted {
    std::string requester;
    std::int64_t after, before;  // us
  };

  /// In turn: one message to each who asks.
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
  /// False: it is too long for what is left of the tick.
  bool send(const Kept& kept) {
    decltype(auto) message = kept.message();
    const auto bytes = static_cast<std::size_t>(message.getEncodedSize());
    if (bytes > bytes_left_ && messages_left_ < kAtOnce) return false;
    bus_.publish(again(channel_), message);
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
  std::deque<Wanted> wanted_;  // whose turn it is comes first
  int messages_left_ = kAtOnce;
  std::size_t bytes_left_ = kBytesAtOnce;
  std::int64_t resent_ = 0;
};

}  // namespace curbstone
