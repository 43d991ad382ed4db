#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace curbstone::serial {

/// Queue of bytes that the kernel did not accept at once. A message is queued as a whole or not at all: after half a
/// command the device would misread the next. Holds at most kMaxBytes bytes.
class SendQueue {
 public:
  static constexpr std::size_t kMaxBytes = 16'384;  ///< bytes: more than a second at 115200 baud

  [[nodiscard]] bool empty() const { return sent_ == bytes_.size(); }
  /// Whether a message of this size fits.
  [[nodiscard]] bool has_room(std::size_t size) const { return size <= kMaxBytes - (bytes_.size() - sent_); }
  void push(std::span<const std::uint8_t> bytes) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(sent_));
    sent_ = 0;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  [[nodiscard]] std::span<const std::uint8_t> front() const { return std::span(bytes_).subspan(sent_); }
  void pop(std::size_t size) {
    sent_ += size;
    if (empty()) clear();
  }
  void clear() {
    bytes_.clear();
    sent_ = 0;
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t sent_ = 0;  // of bytes_
};

}  // namespace curbstone::serial
