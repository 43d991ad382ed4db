#pragma once

#include <string>

#include "tools/bench/mapping/mapping_drive.hpp"

namespace curbstone {

/// A log's LIDAR_POINTS as revolutions; its IMU and WHEELS, if wanted, through our filter as odometry. Throws
/// std::runtime_error when the file is no log.
void play_log(const std::string& file, bool with_odometry, const MappingDrive::Take& take);

}  // namespace curbstone
