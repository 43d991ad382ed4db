#pragma once

#include "tools/doctor/checks/host_checks.hpp"

namespace curbstone::doctor::facts {

/// Reads adjtimex(2), /proc and /sys of this host.
[[nodiscard]] checks::HostFacts read_host();

}  // namespace curbstone::doctor::facts
