#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/resend/recent_messages.hpp"

namespace curbstone {

/// A sent message in encoded form. Publisher::publish() accepts it.
struct EncodedMessage {
  std::int64_t utime = 0;  ///< us
  std::vector<std::uint8_t> encoded;
  [[nodiscard]] std::size_t bytes() const { return encoded.size(); }
  [[nodiscard]] const EncodedMessage& message() const { return *this; }
  [[nodiscard]] int getEncodedSize() const { return static_cast<int>(encoded.size()); }
  int encode(void* to, int offset, int max) const;
};

/// RecentMessages for any message type; the messages are kept encoded.
class MessageKeeper final : public RecentMessages<EncodedMessage> {
 public:
  using RecentMessages::RecentMessages;

  /// Keeps a message that was sent on the channel.
  template <class Message>
  void keep(const Message& message) {
    const int size = message.getEncodedSize();
    if (size <= 0 || !make_room(message.utime, static_cast<std::size_t>(size))) return;
    EncodedMessage kept{message.utime, std::move(forgotten().encoded)};
    kept.encoded.reserve(static_cast<std::size_t>(size));  // exactly this capacity: resize() would round it up
    kept.encoded.resize(static_cast<std::size_t>(size));
    if (message.encode(kept.encoded.data(), 0, size) == size) add(std::move(kept));
  }
};

}  // namespace curbstone
