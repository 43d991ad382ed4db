#pragma once

#include <functional>
#include <string>

#include "tools/output/watched_log.hpp"

namespace curbstone::output {

/// Whether a driver publishes on the channel: LIDAR_POINTS, IMU or WHEELS, the input of a drive.
[[nodiscard]] bool is_of_a_driver(const std::string& channel);

/// Whether a message on a driver's channel has another type than the drivers publish there: that of a foreign program,
/// or of another version of ours. Its times and contents mean nothing here.
[[nodiscard]] bool has_other_type(const LogEvent& event);

/// Passes each message of a `wanted` channel to `take`, in the order of message time (MessageOrder).
void read_in_order(WatchedLog& log, const std::function<bool(const std::string& channel)>& wanted,
                   const std::function<void(const LogEvent&)>& take);

}  // namespace curbstone::output
