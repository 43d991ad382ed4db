#pragma once

#include <cstddef>
#include <cstdint>
#include <curbstone/resend_request_t.hpp>
#include <deque>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace curbstone {

inline constexpr const char* kResendRequests = "RESEND_REQUEST";

/// Where what was sent on `channel` comes again.
[[nodiscard]] inline std::string again(const std::string& channel) {
  return channel + "_AGAIN";
}

/// What a MessageKeeper holds at most.
struct KeepLimits {
  std::int64_t span = 10'000'000;             ///< us, by the stamps of the messages
  std::size_t bytes = std::size_t{64} << 20;  ///< of encoded messages
};

/// The newest messages of a channel, encoded, for listeners that lost some on the bus. Answers go out at a pace that a
/// stock kernel's socket buffer bears beside the channel itself: kAtOnce messages and kBytesAtOnce a tick. One thread.
class MessageKeeper {
 public:
  static constexpr int kAtOnce = 30;                    ///< messages a tick: of 20 ms, twice what a LiDAR sends
  static constexpr std::size_t kBytesAtOnce = 180'000;  ///< a tick
  static constexpr std::size_t kMostAsking = 8;         ///< listeners that are answered at a time

  MessageKeeper(Publisher& bus, std::string channel, KeepLimits limits = {})
      : bus_(bus), channel_(std::move(channel)), limits_(limits) {}

  /// A message that was sent on the channel. They come in the order of their stamps; one that does not is not kept, and
  /// a stamp that jumps back begins anew.
  template <class Message>
  void keep(const Message& message) {
    const int size = message.getEncodedSize();
    if (size <= 0 || !make_room(message.utime, static_cast<std::size_t>(size))) return;
    Encoded kept{message.utime, std::move(spare_)};
    kept.bytes.reserve(static_cast<std::size_t>(size));  // so much and no more: resize() doubles what is too small
    kept.bytes.resize(static_cast<std::size_t>(size));
    if (message.encode(kept.bytes.data(), 0, size) == size) add(std::move(kept));
  }

  /// A request, of any channel. The newest one of a requester replaces the one before.
  void request(const resend_request_t& message);
  /// Each 20 ms: sends a part of what was asked for.
  void tick();

  /// Messages that were sent again.
  [[nodiscard]] std::int64_t resent() const { return resent_; }

 private:
  /// A message that Publisher::publish() takes as it is.
  struct Encoded {
    std::int64_t utime = 0;  // us
    std::vector<std::uint8_t> bytes;
    [[nodiscard]] int getEncodedSize() const { return static_cast<int>(bytes.size()); }
    int encode(void* to, int offset, int max) const;
  };
  struct Wanted {
    std::string requester;
    std::int64_t after, before;  // us
  };
  /// Forgets what is too old or too much. False for a message that is not to be kept.
  [[nodiscard]] bool make_room(std::int64_t utime, std::size_t size);
  void add(Encoded message);
  void send();
  void forget_oldest();

  Publisher& bus_;
  std::string channel_;
  KeepLimits limits_;
  std::deque<Encoded> kept_;
  std::size_t kept_bytes_ = 0;
  std::vector<std::uint8_t> spare_;  // memory of a message that was forgotten
  std::deque<Wanted> wanted_;        // whose turn it is comes first
  int messages_left_ = kAtOnce;
  std::size_t bytes_left_ = kBytesAtOnce;
  std::int64_t resent_ = 0;
};

}  // namespace curbstone
