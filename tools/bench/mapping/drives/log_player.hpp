#pragma once

#include <functional>
#include <string>

#include "common/log/log_reader.hpp"
#include "tools/bench/mapping/drives/mapping_drive.hpp"

namespace curbstone::bench::mapping::drives {

/// A log's LIDAR_POINTS as revolutions; its IMU and WHEELS, if wanted, through our filter as odometry. Throws
/// std::runtime_error when the file is no log.
void play_log(const std::string& file, bool with_odometry, const MappingDrive::Take& take);

/// The same of events that come from elsewhere, in the order in which a log would hold them: `source` hands each to
/// what it is given.
using EventSource = std::function<void(const std::function<void(LogEvent)>& take)>;
void play_events(const EventSource& source, bool with_odometry, const MappingDrive::Take& take);

}  // namespace curbstone::bench::mapping::drives
