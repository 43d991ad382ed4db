#pragma once

#include <string>
#include <vector>

#include "drivers/lidar/models/base/model.hpp"

namespace curbstone::lidar {

/// Reads the angles of a device's lasers from a CSV file: one line per laser, in firing order, "elevation[,azimuth]" in
/// deg. Empty lines and lines that begin with # are skipped. A file without any decimal point whose commas may be
/// decimal ones is refused. Throws std::runtime_error with a one-line message: file, line, what was expected.
[[nodiscard]] std::vector<models::LaserAngles> read_angles(const std::string& file);

}  // namespace curbstone::lidar
