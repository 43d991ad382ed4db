#pragma once

#include "tools/doctor/checks/bus_checks.hpp"

namespace curbstone::doctor::facts {

/// Sends one message to the bus ("CURBSTONE_DOCTOR", to which nothing subscribes) and listens for `seconds` to it and
/// to all other messages. The socket is bound and sized like LCM's; no other process loses messages by it.
/// `unrecorded`: a channel whose bytes are not counted.
[[nodiscard]] checks::BusProbeFacts probe_bus(const BusAddress& address, double seconds, const std::string& unrecorded);

}  // namespace curbstone::doctor::facts
