#pragma once

#include <functional>

namespace curbstone::lidar {

/// Whether the host's clock is synchronised (NTP, PTP), so that it may judge a device's. Called once a second.
using HostClockCheck = std::function<bool()>;

/// The kernel's state: adjtimex(2). A clock that nothing disciplines, or whose discipline has ended, is not
/// synchronised.
[[nodiscard]] bool kernel_clock_is_synchronised();

}  // namespace curbstone::lidar
