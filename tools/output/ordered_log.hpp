#pragma once

#include <functional>
#include <string>

#include "tools/output/watched_log.hpp"

namespace curbstone::output {

/// Whether a driver publishes on the channel: LIDAR_POINTS, IMU or WHEELS, the input of a drive.
[[nodiscard]] bool is_of_a_driver(const std::string& channel);

/// Passes each message of a `wanted` channel to `take`, in the order of message time (MessageOrder).
void read_in_order(WatchedLog& log, const std::function<bool(const std::string& channel)>& wanted,
                   const std::function<void(const LogEvent&)>& take);

}  // namespace curbstone::output
