#include "services/viewer/web/host_rules.hpp"

#include <algorithm>
#include <cctype>
#include <optional>

namespace curbstone::viewer::web {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The name without the port; empty if what follows the colon is not a port.
std::optional<std::string> name_of(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const std::size_t bracket = host.rfind(']');  // of an IPv6 address, which itself contains colons
  if (colon == std::string_view::npos || (bracket != std::string_view::npos && colon < bracket)) return lower(host);
  if (!is_port(host.substr(colon + 1))) return std::nullopt;
  return lower(host.substr(0, colon));
}

}  // namespace

HostRules::HostRules(std::vector<std::string> names) : names_(std::move(names)) {
  for (std::string& name : names_) name = lower(name);
  names_.insert(names_.end(), {"127.0.0.1", "localhost", "[::1]"});
}

bool HostRules::allows_host(std::string_view host) const {
  const auto name = name_of(host);
  return name && std::find(names_.begin(), names_.end(), *name) != names_.end();
}

bool HostRules::allows_origin(std::string_view origin, std::string_view host) const {
  const std::string from = lower(origin);
  return from == "http://" + lower(host) || from == "https://" + lower(host);
}

}  // namespace curbstone::viewer::web
