#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace curbstone {

/// An LCM URL of multicast, taken apart: "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304".
struct BusAddress {
  std::string group = "239.255.76.67";  ///< IPv4
  int port = 7667;
  int ttl = 0;
  int buffer = 0;  ///< bytes of the receive buffer asked for; 0: the kernel's default
};

/// Nothing for another kind of URL, and for one that is damaged. "udpm://" alone has LCM's own group and port.
[[nodiscard]] std::optional<BusAddress> parse_bus_url(std::string_view url);

}  // namespace curbstone
