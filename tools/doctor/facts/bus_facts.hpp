#pragma once

#include <optional>
#include <string>

#include "tools/doctor/checks/bus_checks.hpp"

namespace curbstone::doctor::facts {

/// The URL that the processes use: `url`, else $LCM_DEFAULT_URL, else the default.
[[nodiscard]] std::string bus_url(const std::string& url);

/// The kernel's route to an IPv4 address, by ip(8). Empty if there is none.
[[nodiscard]] std::optional<checks::RouteFacts> read_route(const std::string& address);

}  // namespace curbstone::doctor::facts
