#include "common/bus/socket/bus_address.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <system_error>

namespace curbstone {

namespace {

bool read_number(std::string_view text, int most, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= 0 && value <= most;
}

bool read_option(std::string_view option, BusAddress& address) {
  if (option.empty()) return true;
  const auto equals = option.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view name = option.substr(0, equals), value = option.substr(equals + 1);
  if (name == "ttl") return read_number(value, 255, address.ttl);
  if (name == "recv_buf_size") return read_number(value, 1 << 30, address.buffer);
  return false;
}

bool read_network(std::string_view network, BusAddress& address) {
  if (network.empty()) return true;
  const auto colon = network.find(':');
  address.group = network.substr(0, colon);
  in_addr group{};
  return inet_pton(AF_INET, address.group.c_str(), &group) == 1 && IN_MULTICAST(ntohl(group.s_addr)) &&
         colon != std::string_view::npos && read_number(network.substr(colon + 1), 65535, address.port);
}

}  // namespace

std::optional<BusAddress> parse_bus_url(std::string_view url) {
  constexpr std::string_view kScheme = "udpm://";
  if (!url.starts_with(kScheme)) return std::nullopt;
  url.remove_prefix(kScheme.size());
  const auto question = url.find('?');
  BusAddress address;
  if (!read_network(url.substr(0, question), address)) return std::nullopt;
  std::string_view options = question == std::string_view::npos ? "" : url.substr(question + 1);
  while (!options.empty()) {
    const auto end = options.find('&');
    if (!read_option(options.substr(0, end), address)) return std::nullopt;
    options = end == std::string_view::npos ? "" : options.substr(end + 1);
  }
  return address;
}

std::string effective_bus_url(std::string url, const char* otherwise) {
  if (!url.empty()) return url;
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");
  return from_environment != nullptr && *from_environment != '\0' ? from_environment : otherwise;
}

std::optional<std::string> route_error(const BusAddress& address) {
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(static_cast<std::uint16_t>(address.port));
  inet_pton(AF_INET, address.group.c_str(), &group.sin_addr);
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool fails = fd < 0 || connect(fd, reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0;
  const int error = errno;
  if (fd >= 0) close(fd);
  return fails ? std::optional(std::generic_category().message(error)) : std::nullopt;
}

}  // namespace curbstone
