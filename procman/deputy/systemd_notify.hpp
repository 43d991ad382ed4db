#pragma once

#include <string_view>

namespace curbstone::procman::deputy {

/// Sends "READY=1", "WATCHDOG=1" or "STOPPING=1" to systemd (sd_notify(3)). No effect if systemd did not start this
/// process.
void notify_systemd(std::string_view state);

}  // namespace curbstone::procman::deputy
