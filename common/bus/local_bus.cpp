#include "common/bus/local_bus.hpp"

namespace curbstone {

void LocalBus::inject(const std::string& channel, const void* data, int size) {
  if (tap_ && channel != untapped_) tap_(channel, data, size, 0);
  if (!handlers_.contains(channel)) return;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  queue_.push_back({channel, {bytes, bytes + size}});
}

void LocalBus::tap(Tap tap, QueueLimit, const std::string& except) {
  tap_ = std::move(tap);
  untapped_ = except;
}

void LocalBus::dispatch() {
  while (!queue_.empty()) {
    const Message message = std::move(queue_.front());
    queue_.pop_front();
    for (const auto& handler : handlers_.at(message.channel)) {
      handler(message.bytes.data(), static_cast<int>(message.bytes.size()));
    }
  }
}

void LocalBus::subscribe_bytes(const std::string& channel, BytesHandler handler, QueueLimit) {
  handlers_[channel].push_back(std::move(handler));
}

}  // namespace curbstone
