#pragma once

#include "tools/doctor/checks/vehicle_checks.hpp"

namespace curbstone::doctor::facts {

/// Counts the UDP packets to a port for `seconds`, by sender, without taking them from a running driver: a packet
/// socket (packet(7)) gets copies. That needs CAP_NET_RAW; without it the port itself is opened, if it is free.
[[nodiscard]] checks::LidarFacts probe_lidar(int port, double seconds);

}  // namespace curbstone::doctor::facts
