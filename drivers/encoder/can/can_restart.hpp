#pragma once

#include <string>

namespace curbstone::encoder::can {

/// Asks the kernel to restart a CAN interface that is bus-off, as `ip link set can0 type can restart` does (rtnetlink,
/// IFLA_CAN_RESTART). Needs CAP_NET_ADMIN. Returns the reason of a failure in words; empty on success.
[[nodiscard]] std::string restart_can(const std::string& interface);

}  // namespace curbstone::encoder::can
