#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/viewer/frames/sections.hpp"

namespace curbstone::viewer::foxglove {

/// A point of a cloud; in a frame that the message names.
struct CloudPoint {
  float x = 0, y = 0, z = 0;  ///< m
  float intensity = 0;        ///< 0..255
};

/// foxglove.PointCloud, as protobuf: x, y, z, intensity, all FLOAT32, since a panel knows no scale.
[[nodiscard]] std::string point_message(const std::vector<CloudPoint>& points, const std::string& frame,
                                        std::int64_t utime);
/// A revolution of the LiDAR, in base_link.
[[nodiscard]] std::string scan_message(const std::vector<frames::ScanPoint>& points, std::int64_t utime);

}  // namespace curbstone::viewer::foxglove
