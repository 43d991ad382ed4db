#include "tools/spy/trace/trace_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "common/json/json_text.hpp"
#include "common/terminal/terminal_table.hpp"

namespace curbstone::spy::trace {

namespace {

using Json = nlohmann::json;

constexpr int kProcess = 1;  // all rows belong to one process: the bus
constexpr int kLanes = 100;  // maximum rows of a channel

/// The order from packets to tiles; other channels follow by name.
constexpr std::array<std::string_view, 11> kChain = {
    "LIDAR_POINTS", "IMU",           "WHEELS", "ODOMETRY",       "MAP_POSE",  "MAP_POINTS",
    "VOTED_POINTS", "SEMANTIC_TILE", "CURBS",  "LOCALIZED_POSE", "TILE_INDEX"};

std::size_t place_of(const std::string& channel) {
  return static_cast<std::size_t>(std::find(kChain.begin(), kChain.end(), channel) - kChain.begin());
}

std::int64_t begin_of(const ChainTrace& trace) {
  std::int64_t begin = std::numeric_limits<std::int64_t>::max();
  for (const auto& [channel, spans] : trace.channels())
    for (const auto& [key, span] : spans) begin = std::min(begin, span.measured);
  for (const HeardStatus& heard : trace.statuses()) begin = std::min(begin, heard.arrival);
  return begin;
}

Json row_name(int row, const std::string& name) {
  return {{"ph", "M"}, {"pid", kProcess}, {"tid", row}, {"name", "thread_name"}, {"args", {{"name", name}}}};
}
Json row_order(int row) {
  return {{"ph", "M"}, {"pid", kProcess}, {"tid", row}, {"name", "thread_sort_index"}, {"args", {{"sort_index", row}}}};
}

/// Rows without overlapping spans, because viewers require the spans of a row to be sequential.
class Lanes {
 public:
  /// The first row that is free from `begin` on, then occupied until `end`; the last row if none is free.
  int take(std::int64_t begin, std::int64_t end) {
    for (std::size_t lane = 0; lane < free_from_.size(); ++lane) {
      if (free_from_[lane] > begin) continue;
      free_from_[lane] = end;
      return static_cast<int>(lane);
    }
    if (free_from_.size() < kLanes) free_from_.push_back(end);
    return static_cast<int>(free_from_.size()) - 1;
  }
  [[nodiscard]] int count() const { return static_cast<int>(free_from_.size()); }

 private:
  std::vector<std::int64_t> free_from_;  // us
};

void add_channel(const std::string& channel, const std::map<std::int64_t, Span>& spans, int first_row,
                 std::int64_t begin, Json& events) {
  const std::string name = printable(channel);
  std::vector<Span> sorted;
  for (const auto& [key, span] : spans) sorted.push_back(span);
  std::sort(sorted.begin(), sorted.end(), [](const Span& a, const Span& b) { return a.measured < b.measured; });
  Lanes lanes;
  for (const Span& span : sorted) {
    const std::int64_t end = std::max(span.last_arrival, span.measured + 1);  // another host's clock may be ahead
    events.push_back({{"ph", "X"},
                      {"pid", kProcess},
                      {"tid", first_row + lanes.take(span.measured, end)},
                      {"name", name},
                      {"ts", span.measured - begin},
                      {"dur", end - span.measured},
                      {"args",
                       {{"messages", span.messages},
                        {"bytes", span.bytes},
                        {"first_ms", static_cast<double>(span.first_arrival - span.measured) * 1e-3},
                        {"last_ms", static_cast<double>(span.last_arrival - span.measured) * 1e-3}}}});
  }
  for (int lane = 0; lane < lanes.count(); ++lane) {
    events.push_back(row_name(first_row + lane, lane == 0 ? name : name + " (" + std::to_string(lane + 1) + ")"));
    events.push_back(row_order(first_row + lane));
  }
}

Json curve(const std::string& name, const std::string& unit, std::int64_t at, double value) {
  return {{"ph", "C"}, {"pid", kProcess}, {"name", name}, {"ts", at}, {"args", {{unit, value}}}};
}

/// Adds CPU between two statuses of a process, latency, and faults.
void add_statuses(const std::vector<HeardStatus>& statuses, std::int64_t begin, Json& events) {
  std::map<std::string, const service_status_t*> before;
  for (const HeardStatus& heard : statuses) {
    const service_status_t& now = heard.status;
    const std::string name = printable(now.service);
    const std::int64_t at = heard.arrival - begin;
    const service_status_t*& last = before[now.service];
    if (last != nullptr && last->pid == now.pid && now.uptime > last->uptime) {
      const auto cpu = static_cast<double>(now.cpu_time) - static_cast<double>(last->cpu_time);
      events.push_back(curve(name + ": CPU", "cores", at,
                             cpu / (static_cast<double>(now.uptime) - static_cast<double>(last->uptime))));
    }
    last = &now;
    if (std::isfinite(now.latency_p99))
      events.push_back(curve(name + ": latency p99", "ms", at, 1e3 * double{now.latency_p99}));
    for (const std::string& fault : now.fault)
      events.push_back({{"ph", "i"},
                        {"s", "p"},
                        {"pid", kProcess},
                        {"tid", 0},
                        {"ts", at},
                        {"name", name + ": " + printable(fault)}});
  }
}

}  // namespace

std::string trace_json(const ChainTrace& trace) {
  const std::int64_t begin = begin_of(trace);
  Json events = Json::array();
  events.push_back({{"ph", "M"},
                    {"pid", kProcess},
                    {"name", "process_name"},
                    {"args", {{"name", "bus: from measurement to arrival"}}}});
  std::vector<std::pair<std::size_t, std::string>> order;
  for (const auto& [channel, spans] : trace.channels()) order.emplace_back(place_of(channel), channel);
  std::sort(order.begin(), order.end());
  int row = 1;
  for (const auto& [place, channel] : order) {
    add_channel(channel, trace.channels().at(channel), row, begin, events);
    row += kLanes;
  }
  add_statuses(trace.statuses(), begin, events);
  return json_text(Json{
      {"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}, {"otherData", {{"left_out", trace.left_out()}}}});
}

}  // namespace curbstone::spy::trace
