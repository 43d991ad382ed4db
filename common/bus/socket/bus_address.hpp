#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace curbstone {

/// A parsed LCM URL of UDP multicast: "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304".
struct BusAddress {
  std::string group = "239.255.76.67";  ///< IPv4
  int port = 7667;
  int ttl = 0;
  int buffer = 0;  ///< bytes of the receive buffer to request; 0: the kernel's default
};

/// Parses the URL. Returns nothing for another kind of URL and for a malformed one. "udpm://" alone gives LCM's default
/// group and port.
[[nodiscard]] std::optional<BusAddress> parse_bus_url(std::string_view url);

/// `url`, or if it is empty $LCM_DEFAULT_URL, or if that is empty too `otherwise`.
[[nodiscard]] std::string effective_bus_url(std::string url, const char* otherwise);

/// Why this host cannot send to the address, in the kernel's words: it has no route. Nothing if it can.
[[nodiscard]] std::optional<std::string> route_error(const BusAddress& address);

}  // namespace curbstone
