#pragma once

#include "tools/doctor/checks/vehicle_checks.hpp"

namespace curbstone::doctor::facts {

/// Counts the UDP packets to a port for `seconds`, by sender, without taking them from a driver that runs: by a packet
/// socket (packet(7)), which sees copies. That needs CAP_NET_RAW; without it the port itself is opened, if nobody has
/// it.
[[nodiscard]] checks::LidarFacts probe_lidar(int port, double seconds);

}  // namespace curbstone::doctor::facts
