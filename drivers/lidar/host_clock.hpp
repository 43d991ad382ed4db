#pragma once

#include <functional>

namespace curbstone::lidar {

/// Whether the host's clock is kept by somebody (NTP, PTP), so that it may judge a device's. Asked once a second.
using HostClockCheck = std::function<bool()>;

/// As the kernel says: adjtimex(2). A clock that nobody disciplines, or whose discipline ended, is not synchronised.
[[nodiscard]] bool kernel_clock_is_synchronised();

}  // namespace curbstone::lidar
