#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <queue>
#include <span>
#include <string>
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
/// so a short window suffices. An event that is later than the window keeps its logged place. Events of one channel,
/// and those of equal times, keep their logged order: the result is a function of the log alone. A record with a wrong
/// time, or a logger whose clock was set back, disorders at most the events within the window.
///
/// Where the message time of a channel steps by more than the window, a clock was set, or a stamp is damaged. From
/// there on the channel is sorted as if that step were not there, so it keeps its place among the others, as it was
/// heard on the vehicle. Channels that step by the same, within the window, share a clock: the order among them stays
/// exact.
class MessageOrder {
 public:
  static constexpr std::size_t kMaxWaiting = 65'536;  ///< bound for a log whose record times stand still

  explicit MessageOrder(std::int64_t window_us = 200'000) : window_us_(window_us) {}

  void push(LogEvent event);
  /// The next event, if no later event of the log can precede it.
  [[nodiscard]] std::optional<LogEvent> pop();
  /// The next event, at the end of the log.
  [[nodiscard]] std::optional<LogEvent> pop_rest();
  /// us: the message time of the last event that was popped, without the steps of its channel's clock, but with those
  /// ahead that most channels made: after a gap in the log, or where the clock of all was set.
  [[nodiscard]] std::int64_t time() const { return time_; }

 private:
  struct Waiting {
    std::int64_t key;
    std::uint64_t sequence;
    std::int64_t elapsed;
    std::int64_t time;  // us, for time()
    LogEvent event;
    bool operator<(const Waiting& other) const {  // the earliest is on top
      return key != other.key ? key > other.key : sequence > other.sequence;
    }
  };
  struct Channel {
    std::int64_t since;  // us, elapsed time of its first event
    std::int64_t last;   // us, message time of its newest event
    std::int64_t step;   // us, by which its clock was set so far
    std::int64_t key;    // us, of its newest event
    std::int64_t ahead;  // us, message time without step, less elapsed time, where the latency was least
  };

  [[nodiscard]] std::int64_t key_of(const std::string& name, std::int64_t time);
  [[nodiscard]] std::int64_t first_step(std::int64_t ahead) const;
  [[nodiscard]] std::int64_t shared_step(std::int64_t step) const;
  [[nodiscard]] std::int64_t step_of_most() const;
  void advance(std::int64_t log_utime);

  std::int64_t window_us_;
  std::int64_t elapsed_ = 0;  // us of the log's time
  std::int64_t newest_ = 0;   // us
  std::int64_t time_ = 0;     // us
  std::uint64_t sequence_ = 0;
  std::map<std::string, Channel> channels_;
  std::priority_queue<Waiting> waiting_;
};

}  // namespace curbstone
