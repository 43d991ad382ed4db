#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>

namespace curbstone::spy::board {

/// The figures of a channel over the last kWindow.
struct ChannelRates {
  double rate = 0;  ///< Hz
  double jitter =
      std::numeric_limits<double>::quiet_NaN();  ///< s, standard deviation of the intervals; NaN: fewer than two
  double bandwidth = 0;                          ///< bytes/s
  std::int64_t age = 0;                          ///< us since the last message
};

/// Rate, jitter and bandwidth of a channel, and gaps in its sequence numbers. Pure: times in us of one monotonic clock.
/// Memory is bounded: for a fast channel the window is the last kMaxMessages messages.
class ChannelStatistics {
 public:
  static constexpr std::int64_t kWindow = 5'000'000;  ///< us
  static constexpr std::size_t kMaxMessages = 2000;   ///< messages

  /// Adds a received message. `sequence`: for messages with a sequence number.
  void add(std::int64_t now, std::size_t size, std::optional<std::int64_t> sequence);
  [[nodiscard]] ChannelRates rates(std::int64_t now) const;

  [[nodiscard]] std::int64_t messages() const { return messages_; }
  [[nodiscard]] std::size_t last_size() const { return arrivals_.empty() ? 0 : arrivals_.back().size; }
  /// Messages missing by their sequence numbers; empty if the messages have none. A number that decreases, or jumps by
  /// more than kWholeGap, restarts the count: the sender was restarted.
  [[nodiscard]] std::optional<std::int64_t> lost() const { return lost_; }

 private:
  static constexpr std::int64_t kWholeGap = 10'000;
  struct Arrival {
    std::int64_t time;
    std::size_t size;
  };
  std::deque<Arrival> arrivals_;
  std::int64_t messages_ = 0;
  std::optional<std::int64_t> sequence_;
  std::optional<std::int64_t> lost_;
};

}  // namespace curbstone::spy::board
