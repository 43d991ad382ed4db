#include "tools/export/mcap/foxglove_log.hpp"

#include <algorithm>
#include <iterator>

namespace curbstone::map_export::mcap {
namespace {

using viewer::foxglove::Message;

constexpr std::int64_t kTick = 20'000;                 // us, as live
constexpr std::int64_t kMaxLate = 10'000'000;          // a log of `replay` has its records in the order of computation
constexpr std::int64_t kLast = 9'000'000'000'000'000;  // us; damaged records may have any time
constexpr std::int64_t kEnd = 60'000'000;

}  // namespace

FoxgloveLog::FoxgloveLog(const viewer::ViewerConfig& config)
    : vehicle_(config.vehicle), node_(config, bus_, pages_, {.kind = "replay", .title = ""}), state_(node_, vehicle_) {
  for (const auto& channel : viewer::foxglove::fixed_channels()) feed_.subscribe(channel.id);
  node_.want_scan(true);
  node_.connect(bus_);
  bus_.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { state_.on(m); });
  bus_.subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) { state_.on(m); });
}

std::vector<Message> FoxgloveLog::take(const LogEvent& event) {
  std::vector<Message> messages;
  const std::int64_t utime = std::clamp<std::int64_t>(event.log_utime, 0, kLast);
  const bool is_late = utime < now_ && utime > now_ - kMaxLate;
  if (!is_late) now_ = utime;
  if (now_ != ticked_ && (now_ < ticked_ || now_ >= ticked_ + kTick)) messages = tick(now_);
  bus_.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
  bus_.dispatch();
  return messages;
}

/// Long after the last record everything is due; one large message is sent per tick.
std::vector<Message> FoxgloveLog::finish() {
  std::vector<Message> messages;
  for (std::vector<Message> more = tick(ticked_ + kEnd); !more.empty(); more = tick(ticked_ + kTick))
    messages.insert(messages.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return messages;
}

std::vector<Message> FoxgloveLog::tick(std::int64_t now) {
  ticked_ = now;
  node_.tick(now);
  bus_.dispatch();  // drops tile requests, which have no receiver
  for (; subscribed_services_ < services().size(); ++subscribed_services_)
    feed_.subscribe(viewer::foxglove::kFirstStatus + static_cast<std::uint32_t>(subscribed_services_));
  return feed_.due(state_.world(), now, true);
}

Counters FoxgloveLog::counters() const {
  Counters counters = node_.report().counters;
  for (const Counters& more : {state_.counters(), bus_.counters()}) counters.add(more);
  return counters;
}

}  // namespace curbstone::map_export::mcap
