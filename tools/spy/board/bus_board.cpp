#include "tools/spy/board/bus_board.hpp"

#include <algorithm>

#include "common/bus/decode.hpp"
#include "common/message_types/field_values.hpp"
#include "common/message_types/type_table.hpp"

namespace curbstone::spy::board {

namespace {

bool has_sequence(const MessageType& type) {
  return std::ranges::any_of(
      type.fields, [](const MessageField& field) { return field.name == "sequence" && field.dimensions.empty(); });
}

std::optional<std::int64_t> sequence_in(const std::vector<NamedValue>& values) {
  for (const NamedValue& value : values) {
    if (const auto* number = std::get_if<std::int64_t>(&value.value); number != nullptr && value.name == "sequence")
      return *number;
  }
  return std::nullopt;
}

}  // namespace

void BusBoard::on_message(const std::string& channel, const void* data, std::size_t size, std::int64_t now) {
  if (!channels_.contains(channel) && channels_.size() >= kMaxChannels) {
    ++unlisted_;
    return;
  }
  ChannelState& state = channels_[channel];
  const TypeTable& table = TypeTable::built_in();
  const MessageType* const type = table.type_of(data, size);
  bool is_whole = type != nullptr;
  std::optional<std::int64_t> sequence;
  if (type != nullptr) {
    state.type = type->name;
    // Large messages are not decoded completely: 750 LIDAR_POINTS per second would cost a core.
    if (has_sequence(*type)) {
      const auto values = decode_values(table, data, size);
      is_whole = values.has_value();
      if (values) sequence = sequence_in(*values);
    }
    is_whole = decode_known(channel, data, size, now) && is_whole;
  }
  if (!is_whole) ++state.undecodable;
  state.statistics.add(now, size, sequence);
  if (channel == followed_) {
    const auto* const bytes = static_cast<const std::uint8_t*>(data);
    state.last.assign(bytes, bytes + size);
  }
}

bool BusBoard::decode_known(const std::string& channel, const void* data, std::size_t size, std::int64_t now) {
  if (channel == "SERVICE_STATUS") {
    service_status_t status{};
    if (!decode(data, static_cast<int>(size), status)) return false;
    services_.add(status, now);
  } else if (channel == "PM_INFO") {
    procman_lcm::deputy_info_t info{};
    if (!decode(data, static_cast<int>(size), info)) return false;
    if (deputies_.contains(info.deputy_id) || deputies_.size() < kMaxDeputies)
      deputies_[info.deputy_id] = {info, now, info.utime - now};
  }
  return true;
}

}  // namespace curbstone::spy::board
