#include "tools/doctor/facts/bus_facts.hpp"

#include <nlohmann/json.hpp>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/socket/bus_address.hpp"
#include "common/json/json_text.hpp"
#include "tools/doctor/facts/program_output.hpp"

namespace curbstone::doctor::facts {

namespace {

/// An empty list if ip(8) fails or prints nothing.
nlohmann::json ip_json(std::vector<std::string> words) {
  words.insert(words.begin(), {"ip", "-4", "-json"});
  const auto text = program_output(words);
  const auto parsed = try_parse_json(text.value_or(""));
  return parsed.is_array() ? parsed : nlohmann::json::array();
}

}  // namespace

std::string bus_url(const std::string& url) {
  return effective_bus_url(url, LcmBus::kDefaultUrl);
}

std::optional<checks::RouteFacts> read_route(const std::string& address) {
  checks::RouteFacts route;
  for (const auto& taken : ip_json({"route", "get", address})) route.interface = taken.value("dev", "");
  if (route.interface.empty()) return std::nullopt;
  route.is_loopback = route.interface == "lo";
  // All matching routes: if the default route is the only one, there is no route for the group.
  route.is_default = true;
  for (const auto& match : ip_json({"route", "show", "match", address})) {
    if (match.value("dst", "") != "default") route.is_default = false;
  }
  return route;
}

}  // namespace curbstone::doctor::facts
