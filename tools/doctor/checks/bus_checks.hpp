#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/bus/bus_address.hpp"
#include "tools/doctor/checks/verdict.hpp"

namespace curbstone::doctor::checks {

/// The way that the bus takes out of the host.
struct RouteFacts {
  std::string interface;
  bool is_loopback = false;
  bool is_default = false;  ///< no route for the group; it takes the one of everything else
};

/// What was seen when a message was sent and the port listened to for a while.
struct BusProbeFacts {
  std::string error;                                 ///< why nothing could be sent or heard; empty: it could
  std::optional<std::int64_t> round_trip;            ///< us until the own message was heard
  int granted_buffer = 0;                            ///< bytes that the kernel gave of those asked for
  std::map<std::string, std::int64_t> other_groups;  ///< datagrams on the port that were sent to other groups
  std::int64_t kernel_drops = 0;                     ///< of all sockets on this port, since they were opened
  double seconds = 0;                                ///< of listening
  std::int64_t bytes = 0;                            ///< on the bus that a recorder would write, while listening
  std::map<std::string, std::int64_t> messages;      ///< by channel, while listening
};

struct BusFacts {
  std::string url;
  std::optional<RouteFacts> route;
  BusProbeFacts probe;
};

/// Route, ttl, round trip, receive buffer, losses, other buses.
[[nodiscard]] Verdicts check_bus(const BusFacts& facts);

}  // namespace curbstone::doctor::checks
