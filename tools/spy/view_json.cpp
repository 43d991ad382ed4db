#include <nlohmann/json.hpp>

#include "common/json/json_text.hpp"
#include "common/message_types/field_values.hpp"
#include "common/message_types/type_table.hpp"
#include "tools/spy/view.hpp"

namespace curbstone::spy {

namespace {

using Json = nlohmann::json;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

double in_seconds(std::int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

Json channel_json(const std::string& name, const board::ChannelState& channel, std::int64_t now) {
  const board::ChannelRates rates = channel.statistics.rates(now);
  return {{"channel", printable(name)},
          {"type", channel.type.empty() ? Json(nullptr) : Json(channel.type)},
          {"rate_hz", rates.rate},
          {"jitter_s", rates.jitter},
          {"bytes_per_s", rates.bandwidth},
          {"size", channel.statistics.last_size()},
          {"age_s", in_seconds(rates.age)},
          {"messages", channel.statistics.messages()},
          {"lost", or_null(channel.statistics.lost())},
          {"undecodable", channel.undecodable}};
}

Json service_json(const board::ServiceState& service, std::int64_t now) {
  Json counters = Json::object(), faults = Json::array();
  for (std::size_t k = 0; k < service.status.counter_name.size(); ++k)
    counters[printable(service.status.counter_name[k])] = service.status.counter_value[k];
  for (const std::string& fault : service.status.fault) faults.push_back(printable(fault));
  return {{"service", printable(service.status.service)},
          {"host", printable(service.status.host)},
          {"pid", service.status.pid},
          {"silent", service.is_silent(now)},
          {"faults", faults},
          {"cpu_cores", service.cpu},
          {"memory_bytes", service.status.memory},
          {"latency_p50_s", service.status.latency_p50},
          {"latency_p99_s", service.status.latency_p99},
          {"dropped_per_s", service.dropped},
          {"refused_per_s", service.refused},
          {"clock_s", in_seconds(service.clock)},
          {"counters", counters}};
}

Json deputy_json(const board::DeputyState& deputy, std::int64_t now) {
  Json commands = Json::array();
  for (const auto& command : deputy.info.cmds) {
    commands.push_back({{"id", printable(command.cmd.command_id)},
                        {"pid", command.pid},
                        {"cpu_load", command.cpu_usage},
                        {"memory_bytes", command.mem_rss_bytes}});
  }
  return {{"deputy", printable(deputy.info.deputy_id)},
          {"cpu_load", deputy.info.cpu_load},
          {"memory_free_bytes", deputy.info.phys_mem_free_bytes},
          {"clock_s", in_seconds(deputy.clock)},
          {"age_s", in_seconds(now - deputy.heard)},
          {"commands", commands}};
}

/// The message field by field, or null.
Json message_json(const board::BusBoard& board) {
  const auto found = board.channels().find(board.followed());
  if (found == board.channels().end()) return nullptr;
  const auto& bytes = found->second.last;
  const auto values = decode_values(TypeTable::built_in(), bytes.data(), bytes.size());
  if (!values) return nullptr;
  Json message = Json::object();
  for (const NamedValue& named : *values) {
    const auto* const text = std::get_if<std::string>(&named.value);
    message[named.name] = text != nullptr ? Json(printable(*text))
                                          : std::visit([](const auto& value) { return Json(value); }, named.value);
  }
  return message;
}

}  // namespace

std::string board_json(const board::BusBoard& board, std::int64_t now) {
  Json json = {{"channels", Json::array()}, {"services", Json::array()}, {"deputies", Json::array()}};
  for (const auto& [name, channel] : board.channels()) json["channels"].push_back(channel_json(name, channel, now));
  for (const auto& [key, service] : board.services().services()) json["services"].push_back(service_json(service, now));
  for (const auto& [name, deputy] : board.deputies()) json["deputies"].push_back(deputy_json(deputy, now));
  if (!board.followed().empty()) json["message"] = message_json(board);
  return json_text(json, 2);
}

}  // namespace curbstone::spy
