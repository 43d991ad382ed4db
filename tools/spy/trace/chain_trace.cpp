#include "tools/spy/trace/chain_trace.hpp"

#include <algorithm>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <optional>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/bytes/big_endian.hpp"
#include "common/message_types/type_table.hpp"

namespace curbstone::spy::trace {

namespace {

/// The measurement that a message is about.
struct Measurement {
  std::int64_t key = 0;    // common to all messages of a span
  std::int64_t utime = 0;  // us
};

std::optional<Measurement> measurement_of(const std::string& channel, const void* data, std::size_t size) {
  const MessageType* const type = TypeTable::built_in().type_of(data, size);
  if (type == nullptr || type->fields.empty() || type->fields.front().name != "utime" || size < 16) return std::nullopt;
  const auto utime = static_cast<std::int64_t>(
      read_big_endian<std::uint64_t>({static_cast<const std::uint8_t*>(data) + 8, sizeof(std::uint64_t)}));
  if (channel != "LIDAR_POINTS") return Measurement{utime, utime};  // the packets of a revolution form one span
  lidar_points_t points{};
  if (!decode(data, static_cast<int>(size), points)) return std::nullopt;
  return Measurement{points.revolution, utime};
}

}  // namespace

void ChainTrace::on_message(const std::string& channel, const void* data, std::size_t size, std::int64_t arrival) {
  const std::optional<Measurement> measurement = measurement_of(channel, data, size);
  // A stamp may have any value, so it is compared without overflow.
  if (!measurement || measurement->utime < arrival - kOldest || measurement->utime > arrival - kEarliest) {
    ++left_out_;
    return;
  }
  if (channel == "SERVICE_STATUS") {
    HeardStatus heard{.arrival = arrival, .status = {}};
    if (statuses_.size() < kMaxStatuses && decode(data, static_cast<int>(size), heard.status))
      statuses_.push_back(std::move(heard));
    else
      ++left_out_;
    return;
  }
  if (channel == "SEMANTIC_TILE" && !shows_news(data, size)) return;
  const auto known = channels_.find(channel);
  const bool is_new = known == channels_.end() || !known->second.contains(measurement->key);
  if (is_new && (num_spans_ >= kMaxSpans || (known == channels_.end() && channels_.size() >= kMaxChannels))) {
    ++left_out_;
    return;
  }
  Span& span = channels_[channel][measurement->key];
  if (is_new) {
    ++num_spans_;
    span = {.measured = measurement->utime, .first_arrival = arrival, .last_arrival = arrival};
  }
  span.measured = std::min(span.measured, measurement->utime);
  span.last_arrival = std::max(span.last_arrival, arrival);
  ++span.messages;
  span.bytes += static_cast<std::int64_t>(size);
}

bool ChainTrace::shows_news(const void* data, std::size_t size) {
  semantic_tile_t tile{};
  if (!decode(data, static_cast<int>(size), tile)) return false;
  const std::pair key{tile.tile_x, tile.tile_y};
  const auto known = shown_.find(key);
  if (known == shown_.end() && shown_.size() < kMaxTiles) shown_.emplace(key, tile.utime);
  if (known == shown_.end()) return true;
  return std::exchange(known->second, std::max(known->second, tile.utime)) < tile.utime;
}

}  // namespace curbstone::spy::trace
