#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <queue>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/bytes/big_endian.hpp"
#include "common/log/log_reader.hpp"

namespace curbstone {

/// The utime of an encoded message: its first field, as in every type of package curbstone. us since the Unix epoch. 0
/// if the message is too short. For logs of any types; if the type is known, decode() it.
[[nodiscard]] inline std::int64_t message_time(const void* data, std::size_t size) {
  if (size < 16) return 0;
  const std::span<const std::uint8_t> bytes(static_cast<const std::uint8_t*>(data), size);
  return static_cast<std::int64_t>(read_big_endian<std::uint64_t>(bytes.subspan(8)));  // after the fingerprint
}
[[nodiscard]] inline std::int64_t message_time(const LogEvent& event) {
  return message_time(event.bytes.data(), event.bytes.size());
}

/// Sorts the events of a log by message time. The logged order differs from it by no more than the sensors' latencies,
/// so a short window suffices. An event that is later than the window keeps its logged place. Equal times keep their
/// logged order: the result is a function of the log alone. A record with a wrong time, or a logger whose clock was set
/// back, disorders at most the events within the window. If the message time of a channel goes back by more than the
/// window, the clock of the vehicle was set: events logged before the step then precede those logged after it.
class MessageOrder {
 public:
  static constexpr std::size_t kMaxWaiting = 65'536;  ///< bound for a log whose record times stand still

  explicit MessageOrder(std::int64_t window_us = 200'000) : window_us_(window_us) {}

  void push(LogEvent event) {
    advance(event.log_utime);
    const std::int64_t time = message_time(event);
    const auto [last, is_first] = last_.try_emplace(event.channel, time);
    if (!is_first && time < std::exchange(last->second, time) - window_us_) ++clock_;
    waiting_.push({clock_, time, sequence_++, elapsed_, std::move(event)});
  }
  /// The next event that no later event of the log can precede. With `drain`, the next remaining event.
  [[nodiscard]] std::optional<LogEvent> pop(bool drain) {
    if (waiting_.empty()) return std::nullopt;
    const bool may_be_preceded = waiting_.top().clock == clock_ && waiting_.top().elapsed + window_us_ > elapsed_ &&
                                 waiting_.size() <= kMaxWaiting;
    if (!drain && may_be_preceded) return std::nullopt;
    LogEvent event = waiting_.top().event;
    waiting_.pop();
    return event;
  }

 private:
  struct Waiting {
    std::int64_t clock;
    std::int64_t time;
    std::uint64_t sequence;
    std::int64_t elapsed;
    LogEvent event;
    bool operator<(const Waiting& other) const {  // the earliest is on top
      if (clock != other.clock) return clock > other.clock;
      return time != other.time ? time > other.time : sequence > other.sequence;
    }
  };

  /// Advances the log's time. A forward step counts for at most the window. After a step back by more than the window
  /// the time continues from there.
  void advance(std::int64_t log_utime) {
    if (sequence_ == 0) newest_ = log_utime;
    const std::int64_t step = log_utime - newest_;
    if (step < 0 && step >= -window_us_) return;
    elapsed_ += std::clamp(step, std::int64_t{0}, window_us_);
    newest_ = log_utime;
  }

  std::int64_t window_us_;
  std::int64_t elapsed_ = 0;                            // us of the log's time
  std::int64_t clock_ = 0;                              // steps back of a channel's time
  std::unordered_map<std::string, std::int64_t> last_;  // us, message time of the channel's previous event
  std::int64_t newest_ = 0;                             // us
  std::uint64_t sequence_ = 0;
  std::priority_queue<Waiting> waiting_;
};

}  // namespace curbstone
