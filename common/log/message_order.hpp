#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <queue>
#include <vector>

#include "common/log/log_reader.hpp"

namespace curbstone {

/// When the measurement of an encoded message was taken: its first field, as in every type of ours. 0 if it is too
/// short.
[[nodiscard]] inline std::int64_t message_time(const void* data, std::size_t size) {
  if (size < 16) return 0;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  std::uint64_t utime = 0;
  for (std::size_t i = 8; i < 16; ++i) utime = (utime << 8) | bytes[i];  // after the 8-byte fingerprint, big-endian
  return static_cast<std::int64_t>(utime);
}
[[nodiscard]] inline std::int64_t message_time(const LogEvent& event) {
  return message_time(event.bytes.data(), event.bytes.size());
}

/// Puts the events of a log into the order of their message times. Logged order differs from it by no more than the
/// sensors' latencies, so a short window is enough; what is later than that keeps its logged place. Equal times keep
/// their logged order: the result is a function of the log alone.
class MessageOrder {
 public:
  explicit MessageOrder(std::int64_t window_us = 200'000) : window_us_(window_us) {}

  void push(LogEvent event) {
    const std::int64_t time = message_time(event);
    newest_ = std::max(newest_, event.log_utime);
    waiting_.push({time, sequence_++, std::move(event)});
  }
  /// The next event that nothing newer in the log can precede; with `drain`, whatever is left.
  [[nodiscard]] std::optional<LogEvent> pop(bool drain) {
    if (waiting_.empty()) return std::nullopt;
    if (!drain && waiting_.top().event.log_utime + window_us_ > newest_) return std::nullopt;
    LogEvent event = waiting_.top().event;
    waiting_.pop();
    return event;
  }

 private:
  struct Waiting {
    std::int64_t time;
    std::uint64_t sequence;
    LogEvent event;
    bool operator<(const Waiting& other) const {  // the earliest on top
      return time != other.time ? time > other.time : sequence > other.sequence;
    }
  };
  std::int64_t window_us_;
  std::int64_t newest_ = INT64_MIN;
  std::uint64_t sequence_ = 0;
  std::priority_queue<Waiting> waiting_;
};

}  // namespace curbstone
