#include "tools/exporter/metrics_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/levels.hpp"
#include "common/terminal/terminal_table.hpp"

namespace curbstone::exporter {

namespace {

using spy::board::BusBoard;
using spy::board::ChannelState;
using spy::board::DeputyState;
using spy::board::ServiceState;
using Labels = std::vector<std::pair<std::string_view, std::string>>;

double in_seconds(std::int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

/// Escapes a label's value. Names come from the bus: unprintable characters become '?'.
std::string escaped(const std::string& value) {
  std::string text;
  for (const char c : printable(value)) {
    if (c == '\\' || c == '"') text += '\\';
    text += c;
  }
  return text;
}

class MetricsWriter {
 public:
  /// Begins a metric; its samples must follow.
  void metric(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
  }
  void sample(const Labels& labels, double value) {
    if (std::isnan(value)) return;
    std::vector<std::string> pairs;
    for (const auto& [label, content] : labels) pairs.push_back(fmt::format("{}=\"{}\"", label, escaped(content)));
    text_ += fmt::format("{}{{{}}} {}\n", name_, fmt::join(pairs, ","), value);
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string_view name_;
  std::string text_;
};

void write_channels(const BusBoard& board, std::int64_t now, MetricsWriter& out) {
  const auto all = [&](const std::function<double(const ChannelState&)>& value) {
    for (const auto& [name, channel] : board.channels()) out.sample({{"channel", name}}, value(channel));
  };
  out.metric("curbstone_channel_messages_total", "counter", "Messages heard.");
  all([](const ChannelState& c) { return static_cast<double>(c.statistics.messages()); });
  out.metric("curbstone_channel_rate_hertz", "gauge", "Messages a second, over the last five seconds.");
  all([&](const ChannelState& c) { return c.statistics.rates(now).rate; });
  out.metric("curbstone_channel_bandwidth_bytes", "gauge", "Bytes a second, over the last five seconds.");
  all([&](const ChannelState& c) { return c.statistics.rates(now).bandwidth; });
  out.metric("curbstone_channel_age_seconds", "gauge", "Since the last message.");
  all([&](const ChannelState& c) { return in_seconds(c.statistics.rates(now).age); });
  out.metric("curbstone_channel_lost_total", "counter", "Gaps in the sequence numbers, where there are some.");
  all([](const ChannelState& c) {
    const auto lost = c.statistics.lost();
    return lost ? static_cast<double>(*lost) : std::nan("");
  });
  out.metric("curbstone_channel_undecodable_total", "counter", "Messages of no known type, and damaged ones.");
  all([](const ChannelState& c) { return static_cast<double>(c.undecodable); });
}

Labels labels_of(const ServiceState& service) {
  return {{"service", service.status.service}, {"host", service.status.host}};
}

/// The counters of all services that are levels, or those that are not.
void write_counters(const BusBoard& board, bool levels, MetricsWriter& out) {
  for (const auto& [key, service] : board.services().services()) {
    for (std::size_t k = 0; k < service.status.counter_name.size(); ++k) {
      const std::string& name = service.status.counter_name[k];
      if (is_level(name) != levels) continue;
      Labels labels = labels_of(service);
      labels.emplace_back("name", name);
      out.sample(labels, static_cast<double>(service.status.counter_value[k]));
    }
  }
}

void write_services(const BusBoard& board, std::int64_t now, MetricsWriter& out) {
  const auto all = [&](const std::function<double(const ServiceState&)>& value) {
    for (const auto& [key, service] : board.services().services()) out.sample(labels_of(service), value(service));
  };
  out.metric("curbstone_service_up", "gauge", "1 if it spoke in the last three seconds.");
  all([&](const ServiceState& s) { return s.is_silent(now) ? 0.0 : 1.0; });
  out.metric("curbstone_service_faults", "gauge", "Faults that it reports now.");
  all([](const ServiceState& s) { return static_cast<double>(s.status.fault.size()); });
  out.metric("curbstone_service_uptime_seconds", "gauge", "Since its start.");
  all([](const ServiceState& s) { return in_seconds(s.status.uptime); });
  out.metric("curbstone_service_cpu_seconds_total", "counter", "CPU time of all its threads.");
  all([](const ServiceState& s) { return in_seconds(s.status.cpu_time); });
  out.metric("curbstone_service_memory_bytes", "gauge", "Resident.");
  all([](const ServiceState& s) { return static_cast<double>(s.status.memory); });
  out.metric("curbstone_service_latency_median_seconds", "gauge", "From a measurement to what was made of it.");
  all([](const ServiceState& s) { return static_cast<double>(s.status.latency_p50); });
  out.metric("curbstone_service_latency_p99_seconds", "gauge", "The same, of the slowest of a hundred.");
  all([](const ServiceState& s) { return static_cast<double>(s.status.latency_p99); });
  out.metric("curbstone_service_counter_total", "counter", "Its own counters, since its start.");
  write_counters(board, false, out);
  out.metric("curbstone_service_level", "gauge", "Those of its counters that are present values.");
  write_counters(board, true, out);
}

void write_deputies(const BusBoard& board, MetricsWriter& out) {
  const auto all = [&](const std::function<double(const DeputyState&)>& value) {
    for (const auto& [name, deputy] : board.deputies()) out.sample({{"deputy", name}}, value(deputy));
  };
  out.metric("curbstone_deputy_cpu_load", "gauge", "0 to 1, of its whole host.");
  all([](const DeputyState& d) { return static_cast<double>(d.info.cpu_load); });
  out.metric("curbstone_deputy_memory_free_bytes", "gauge", "Of its host.");
  all([](const DeputyState& d) { return static_cast<double>(d.info.phys_mem_free_bytes); });
  out.metric("curbstone_deputy_clock_seconds", "gauge", "Clock of its host minus that of this one, less the way here.");
  all([](const DeputyState& d) { return in_seconds(d.clock); });
  const auto commands = [&](const std::function<double(const procman_lcm::cmd_status_t&)>& value) {
    for (const auto& [name, deputy] : board.deputies()) {
      for (const auto& command : deputy.info.cmds)
        out.sample({{"deputy", name}, {"command", command.cmd.command_id}}, value(command));
    }
  };
  out.metric("curbstone_command_running", "gauge", "1 if the process runs.");
  commands([](const procman_lcm::cmd_status_t& c) { return c.pid != 0 ? 1.0 : 0.0; });
  out.metric("curbstone_command_cpu_load", "gauge", "0 to 1, of its whole host.");
  commands([](const procman_lcm::cmd_status_t& c) { return static_cast<double>(c.cpu_usage); });
  out.metric("curbstone_command_memory_bytes", "gauge", "Resident.");
  commands([](const procman_lcm::cmd_status_t& c) { return static_cast<double>(c.mem_rss_bytes); });
}

}  // namespace

std::string metrics_text(const BusBoard& board, std::int64_t now) {
  MetricsWriter out;
  write_channels(board, now, out);
  write_services(board, now, out);
  write_deputies(board, out);
  return out.take();
}

}  // namespace curbstone::exporter
