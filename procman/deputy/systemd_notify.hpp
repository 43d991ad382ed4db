#pragma once

#include <string_view>

namespace curbstone::procman::deputy {

/// Tells systemd "READY=1", "WATCHDOG=1", "STOPPING=1" (sd_notify(3)). Does nothing when systemd has not started us.
void notify_systemd(std::string_view state);

}  // namespace curbstone::procman::deputy
