#pragma once

#include <string>

#include "tools/calibrate/calibration_data.hpp"
#include "tools/recording/recorded_config.hpp"

namespace curbstone::calibrate {

/// Reads a log for calibration. Uses its MAP_POSEs if it has any, which were made with the extrinsics that the log
/// recorded of the mapper; if it recorded none, with those of `config_file`. Otherwise, or with `map_anew`, runs filter
/// and mapper over its LIDAR_POINTS, IMU and WHEELS. Throws std::runtime_error if the file is not a log or lacks a
/// sensor, ConfigError if the configuration is wrong.
[[nodiscard]] CalibrationData read_drive(const std::string& log, const std::string& config_file,
                                         const recording::RecordedConfig& recorded, bool map_anew);

}  // namespace curbstone::calibrate
