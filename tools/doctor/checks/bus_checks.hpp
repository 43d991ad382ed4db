#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/bus/socket/bus_address.hpp"
#include "tools/doctor/checks/verdict.hpp"

namespace curbstone::doctor::checks {

/// The route of the bus out of this host.
struct RouteFacts {
  std::string interface;
  bool is_loopback = false;
  bool is_default = false;  ///< there is no route for the group, so it takes the default route
};

/// Results of sending one message and listening on the port for a while.
struct BusProbeFacts {
  std::string error;                                 ///< why sending or listening failed; empty: it worked
  std::optional<std::int64_t> round_trip;            ///< us until the own message was received
  int granted_buffer = 0;                            ///< bytes granted by the kernel of those requested
  std::map<std::string, std::int64_t> other_groups;  ///< datagrams on the port that were sent to other groups
  std::int64_t kernel_drops = 0;                     ///< of all sockets on this port, since they were opened
  double seconds = 0;                                ///< of listening
  std::int64_t bytes = 0;                            ///< received on the bus that a recorder would write
  std::map<std::string, std::int64_t> messages;      ///< received, by channel
  std::map<std::string, std::string> config_hashes;  ///< of the services that run on this host, by name
};

struct BusFacts {
  std::string url;
  std::optional<RouteFacts> route;
  BusProbeFacts probe;
};

/// Route, ttl, round trip, receive buffer, losses, other buses.
[[nodiscard]] Verdicts check_bus(const BusFacts& facts);

}  // namespace curbstone::doctor::checks
