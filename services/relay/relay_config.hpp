#pragma once

#include <netinet/in.h>

#include <string>
#include <vector>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"

namespace curbstone::relay {

/// Section `relay` of the vehicle's file.
struct RelayConfig {
  VehicleConfig vehicle;
  std::string peers;   ///< "192.168.2.1, 192.168.2.2:7721"
  int port = 7720;     ///< UDP
  std::string except;  ///< channels, separated by commas

  void visit(ConfigVisitor& v) {
    v.section("vehicle", vehicle, "the vehicle");
    v.field("peers", peers,
            "the hosts to join: IPv4 addresses, with :PORT where it is another, with commas; this host may be one");
    v.field("port", port, {1, 65535}, "UDP port of this relay, and of peers that name none");
    v.field("except", except, "channels that stay on this host, with commas");
  }
};

/// The items of a comma-separated list, without spaces.
[[nodiscard]] std::vector<std::string> split_list(const std::string& list);
/// Throws std::invalid_argument that names an item that is not an IPv4 address with a port, or if there is no item.
[[nodiscard]] std::vector<sockaddr_in> peer_addresses(const RelayConfig& config);

}  // namespace curbstone::relay
