#include "services/viewer/foxglove/status_history.hpp"

#include <fmt/format.h>
#include <foxglove/log.pb.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "common/json/json_text.hpp"
#include "services/viewer/foxglove/message_parts.hpp"

namespace curbstone::viewer::foxglove {
namespace {

using nlohmann::json;

/// Shortened, and valid UTF-8 whatever the bus delivered: protobuf accepts nothing else.
std::string cleaned(const std::string& text) {
  return parse_json(json_text(text.substr(0, StatusHistory::kMaxText))).get<std::string>();
}

/// Makes a name usable in a plot's path, which needs quotes for any other characters.
std::string plain(std::string name) {
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

double seconds(std::int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

json counters_of(const service_status_t& message) {
  json counters = json::object();
  const std::size_t n =
      std::min({message.counter_name.size(), message.counter_value.size(), StatusHistory::kMaxCounters});
  for (std::size_t i = 0; i < n; ++i)
    counters[plain(message.counter_name[i].substr(0, StatusHistory::kMaxText))] = message.counter_value[i];
  return counters;
}

}  // namespace

bool StatusHistory::put(const service_status_t& message) {
  const std::string name = cleaned(message.service);
  auto known =
      std::find_if(services_.begin(), services_.end(), [&](const Service& service) { return service.name == name; });
  if (known == services_.end()) {
    if (services_.size() >= kMaxServices) return false;
    known = services_.insert(known, {.name = name, .topic = "/status/" + plain(name), .json = {}});
  }
  Service& service = *known;
  const bool goes_on = service.pid == message.pid && service.uptime < message.uptime;
  if (service.number == 0 || service.pid != message.pid)
    add_line(message, Level::kInfo, name, fmt::format("runs: {}, process {}", cleaned(message.version), message.pid));
  const double cpu =
      goes_on ? seconds(message.cpu_time - service.cpu_time) / seconds(message.uptime - service.uptime) : 0;

  std::set<std::string> faults;
  for (std::size_t i = 0; i < std::min(message.fault.size(), kMaxFaults); ++i) faults.insert(cleaned(message.fault[i]));
  for (const std::string& fault : faults)
    if (!service.faults.contains(fault)) add_line(message, Level::kError, name, fault);
  for (const std::string& fault : service.faults)
    if (!faults.contains(fault)) add_line(message, Level::kInfo, name, "no longer: " + fault);

  service.json = json_text({{"utime", message.utime},
                            {"host", cleaned(message.host)},
                            {"pid", message.pid},
                            {"version", cleaned(message.version)},
                            {"uptime", seconds(message.uptime)},
                            {"cpu", cpu},
                            {"memory", message.memory},
                            {"latency_p50", message.latency_p50},
                            {"latency_p99", message.latency_p99},
                            {"counters", counters_of(message)},
                            {"faults", faults}});
  service.faults = std::move(faults);
  service.utime = message.utime;
  service.pid = message.pid;
  service.uptime = message.uptime;
  service.cpu_time = message.cpu_time;
  ++service.number;
  return true;
}

void StatusHistory::add_line(const service_status_t& message, Level level, const std::string& name, std::string text) {
  lines_.push_back({++number_, message.utime, level, name, std::move(text)});
  if (lines_.size() > kMaxLines) lines_.pop_front();
}

std::string log_message(const StatusHistory::Line& line) {
  ::foxglove::Log log;
  set_time(*log.mutable_timestamp(), line.utime);
  log.set_level(line.level == StatusHistory::Level::kError ? ::foxglove::Log::ERROR : ::foxglove::Log::INFO);
  log.set_message(line.text);
  log.set_name(line.name);
  return log.SerializeAsString();
}

}  // namespace curbstone::viewer::foxglove
