#include "tools/export/mcap/mcap_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/log/message_order.hpp"
#include "common/mcap/mcap_writer.hpp"
#include "tools/export/mcap/foxglove_log.hpp"
#include "tools/export/mcap/lcm_schemas.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::map_export::mcap {
namespace {

namespace foxglove = viewer::foxglove;

std::uint64_t nanoseconds(std::int64_t utime) {
  constexpr std::int64_t kLast = 9'000'000'000'000'000;  // us; later times do not fit in ns
  return static_cast<std::uint64_t>(std::clamp<std::int64_t>(utime, 0, kLast)) * 1000;
}

/// The ids of the file's schemas and channels; each is written once.
class Channels {
 public:
  explicit Channels(McapWriter& writer) : writer_(writer) {
    for (const auto& channel : foxglove::fixed_channels()) add(channel);
  }

  [[nodiscard]] std::uint16_t of(const foxglove::Message& message, const FoxgloveLog& show) {
    const auto known = shown_.find(message.channel);
    if (known != shown_.end()) return known->second;
    const std::size_t index = message.channel - foxglove::kFirstStatus;
    return add(foxglove::status_channel(index, show.services().at(index).topic));
  }
  /// Empty: there are too many channels.
  [[nodiscard]] std::optional<std::uint16_t> of(const LogEvent& event) {
    const auto size = std::min<std::size_t>(event.bytes.size(), 8);
    const std::string fingerprint(event.bytes.begin(), event.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const auto known = raw_.find({event.channel, fingerprint});
    if (known != raw_.end()) return known->second;
    if (raw_.size() >= kMaxRawChannels) return std::nullopt;
    const auto schema = lcm_.of(event.bytes.data(), event.bytes.size());
    const std::uint16_t id = writer_.add_channel(event.channel, "lcm", schema ? schema_id(*schema) : std::uint16_t{0});
    raw_.emplace(std::pair{event.channel, fingerprint}, id);
    return id;
  }

 private:
  std::uint16_t add(const foxglove::Channel& channel) {
    const std::uint16_t schema = schema_id({channel.schema_name, channel.schema_encoding, channel.schema});
    return shown_.emplace(channel.id, writer_.add_channel(channel.topic, channel.encoding, schema)).first->second;
  }
  std::uint16_t schema_id(const McapSchema& schema) {
    const auto known = schemas_.find(schema.name);
    if (known != schemas_.end()) return known->second;
    return schemas_.emplace(schema.name, writer_.add_schema(schema)).first->second;
  }

  McapWriter& writer_;
  LcmSchemas lcm_;
  std::map<std::string, std::uint16_t> schemas_;
  std::map<std::uint32_t, std::uint16_t> shown_;
  std::map<std::pair<std::string, std::string>, std::uint16_t> raw_;  // by name and fingerprint
};

std::int64_t refused_in(const Counters& counters) {
  std::int64_t refused = 0;
  for (const auto& [name, value] : counters.values())
    if (name.starts_with("refused.")) refused += value;
  return refused;
}

}  // namespace

McapResult write_mcap(const std::string& log, const std::string& path, const viewer::ViewerConfig& config,
                      const McapSettings& settings) {
  output::WatchedLog events(log, "export");
  std::ofstream out(path, std::ios::binary);
  if (!out) throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
  McapWriter writer(out, {.compression = settings.compression});
  Channels channels(writer);
  FoxgloveLog show(config);
  McapResult result;
  const auto write_shown = [&](const std::vector<foxglove::Message>& messages) {
    for (const foxglove::Message& message : messages)
      writer.write(channels.of(message, show), nanoseconds(show.now()), nanoseconds(message.utime), message.payload);
  };
  while (const auto event = events.next()) {
    write_shown(show.take(*event));
    if (!settings.raw) continue;
    const std::string_view bytes(reinterpret_cast<const char*>(event->bytes.data()), event->bytes.size());
    if (const auto channel = channels.of(*event))
      writer.write(*channel, nanoseconds(event->log_utime), nanoseconds(message_time(*event)), bytes);
    else
      ++result.left_out;
  }
  write_shown(show.finish());
  writer.finish();
  result.messages = writer.messages();
  result.has_map = show.has_map();
  result.refused = refused_in(show.counters());
  result.log_is_damaged = events.damaged();
  return result;
}

}  // namespace curbstone::map_export::mcap
