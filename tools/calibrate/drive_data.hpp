#pragma once

#include <string>

#include "tools/calibrate/calibration_data.hpp"

namespace curbstone::calibrate {

/// Reads a log for calibration. Its MAP_POSEs are taken if it has any, which were made with `config_file`'s extrinsics;
/// if not, or with `map_anew`, filter and mapper run over its LIDAR_POINTS, IMU and WHEELS. Throws std::runtime_error
/// when the log is none or lacks a sensor, ConfigError when the file is wrong.
[[nodiscard]] CalibrationData read_drive(const std::string& log, const std::string& config_file, bool map_anew);

}  // namespace curbstone::calibrate
