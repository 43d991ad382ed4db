#pragma once

#include <cstddef>
#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::spy::trace {

/// The messages of one measurement on a channel. Times in us since the Unix epoch.
struct Span {
  std::int64_t measured = 0;  ///< for a LiDAR revolution: its first shot
  std::int64_t first_arrival = 0;
  std::int64_t last_arrival = 0;
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
};

/// A SERVICE_STATUS and its time of reception, us.
struct HeardStatus {
  std::int64_t arrival = 0;
  service_status_t status;
};

/// Latency from stamp to reception, channel by channel: where time is spent from packets to tiles. Messages of one
/// channel with one stamp form a span; packets are grouped by their revolution, and a tile counts when it first shows a
/// measurement. Pure; invalid bytes are tolerated, and memory is bounded.
class ChainTrace {
 public:
  static constexpr std::size_t kMaxSpans = 200'000;  ///< one minute of a whole vehicle
  static constexpr std::size_t kMaxChannels = 500;
  static constexpr std::size_t kMaxStatuses = 20'000;
  static constexpr std::size_t kMaxTiles = 100'000;
  static constexpr std::int64_t kOldest = 10'000'000;    ///< us in transit; older: from a log, or a repeated state
  static constexpr std::int64_t kEarliest = -1'000'000;  ///< us: the other host's clock is ahead

  void on_message(const std::string& channel, const void* data, std::size_t size, std::int64_t arrival);

  /// By channel, then by revolution or stamp.
  [[nodiscard]] const std::map<std::string, std::map<std::int64_t, Span>>& channels() const { return channels_; }
  [[nodiscard]] const std::vector<HeardStatus>& statuses() const { return statuses_; }
  [[nodiscard]] std::size_t spans() const { return num_spans_; }
  /// Messages without a stamp, outside kEarliest .. kOldest, or beyond the bounds.
  [[nodiscard]] std::int64_t left_out() const { return left_out_; }

 private:
  /// Whether a tile shows a new measurement. Tiles are also sent again for their curbs, for their neighbours, and on
  /// request.
  bool shows_news(const void* data, std::size_t size);

  std::map<std::string, std::map<std::int64_t, Span>> channels_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int64_t> shown_;  // newest measurement of a tile, us
  std::vector<HeardStatus> statuses_;
  std::size_t num_spans_ = 0;
  std::int64_t left_out_ = 0;
};

}  // namespace curbstone::spy::trace
