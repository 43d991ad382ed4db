#pragma once

#include <functional>
#include <string>

#include "common/log/log_reader.hpp"
#include "tools/bench/mapping/drives/mapping_drive.hpp"

namespace curbstone::bench::mapping::drives {

/// Plays a log's LIDAR_POINTS as revolutions; if wanted, its IMU and WHEELS through our filter as odometry. Throws
/// std::runtime_error if the file is not a log.
void play_log(const std::string& file, bool with_odometry, const MappingDrive::Take& take);

/// The same for events from another source, in the order of a log. `source` passes each event to its argument.
using EventSource = std::function<void(const std::function<void(LogEvent)>& take)>;
void play_events(const EventSource& source, bool with_odometry, const MappingDrive::Take& take);

}  // namespace curbstone::bench::mapping::drives
