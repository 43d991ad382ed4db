#include "services/relay/relay_config.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

namespace curbstone::relay {

namespace {

sockaddr_in parse_address(const std::string& text, int default_port) {
  const auto colon = text.find(':');
  int port = default_port;
  bool valid = true;
  if (colon != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, port);
    valid = error == std::errc() && stop == end && port >= 1 && port <= 65535;
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (!valid || inet_pton(AF_INET, text.substr(0, colon).c_str(), &address.sin_addr) != 1)
    throw std::invalid_argument(fmt::format("relay.peers: {} is no IPv4 address, nor one with :PORT", text));
  return address;
}

}  // namespace

std::vector<std::string> split_list(const std::string& list) {
  std::vector<std::string> words(1);
  for (const char c : list) {
    if (c == ',')
      words.emplace_back();
    else if (c != ' ')
      words.back() += c;
  }
  std::erase(words, "");
  return words;
}

std::vector<sockaddr_in> peer_addresses(const RelayConfig& config) {
  std::vector<sockaddr_in> addresses;
  for (const std::string& peer : split_list(config.peers)) addresses.push_back(parse_address(peer, config.port));
  if (addresses.empty()) throw std::invalid_argument("relay.peers: names no other host");
  return addresses;
}

}  // namespace curbstone::relay
