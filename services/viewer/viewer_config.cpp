#include "services/viewer/viewer_config.hpp"

#include <fmt/format.h>

namespace curbstone::viewer {
namespace {

/// The words between commas, without spaces.
std::vector<std::string> split_names(const std::string& list) {
  std::vector<std::string> names(1);
  for (const char c : list) {
    if (c == ',')
      names.emplace_back();
    else if (c != ' ')
      names.back() += c;
  }
  std::erase(names, "");
  return names;
}

}  // namespace

web::WebSettings web_settings(const ViewerConfig& config) {
  web::WebSettings settings;
  settings.address = config.address;
  settings.port = static_cast<std::uint16_t>(config.port);
  settings.ports = config.ports;
  settings.network = config.network;
  settings.names = split_names(config.names);
  settings.folder = config.assets;
  settings.limits.pages = static_cast<std::size_t>(config.pages);
  settings.limits.connections = settings.limits.pages + 40;
  return settings;
}

std::string page_address(const ViewerConfig& config, std::uint16_t port) {
  std::string host = config.address;
  if (host == "0.0.0.0" || host == "::") host = "localhost";
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  return fmt::format("http://{}:{}/", host, port);
}

}  // namespace curbstone::viewer
