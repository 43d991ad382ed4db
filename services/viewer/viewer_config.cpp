#include "services/viewer/viewer_config.hpp"

#include <fmt/format.h>

#include <iterator>

#include "services/viewer/foxglove/wire.hpp"

namespace curbstone::viewer {
namespace {

/// Splits at commas and drops spaces.
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

web::WebSettings endpoint_settings(const ViewerConfig& config) {
  web::WebSettings settings = web_settings(config);
  settings.port = static_cast<std::uint16_t>(config.foxglove_port);
  settings.ports = 1;
  settings.subprotocols.assign(std::begin(foxglove::kSubprotocols), std::end(foxglove::kSubprotocols));
  settings.origins = split_names(config.foxglove_origins);
  settings.limits.message_bytes = 16'384;            // a client asks for all topics at once
  settings.limits.frames = 10'000;                   // foxglove::Endpoint bounds their bytes
  settings.limits.write = std::chrono::seconds(30);  // the whole map is 24 MB
  return settings;
}

std::string page_address(const ViewerConfig& config, std::uint16_t port) {
  std::string host = config.address;
  if (host == "0.0.0.0" || host == "::") host = "localhost";
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  return fmt::format("http://{}:{}/", host, port);
}

}  // namespace curbstone::viewer
