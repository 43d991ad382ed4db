#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/viewer/frames/sections.hpp"

namespace curbstone::viewer::foxglove {

/// A point of a cloud, in the frame that the message names.
struct CloudPoint {
  float x = 0, y = 0, z = 0;  ///< m
  float intensity = 0;        ///< 0..255
};

/// Makes a foxglove.PointCloud, as protobuf: x, y, z and intensity, all FLOAT32, because a panel cannot scale integers.
[[nodiscard]] std::string point_message(const std::vector<CloudPoint>& points, const std::string& frame,
                                        std::int64_t utime);
/// The same of a LiDAR revolution in base_link.
[[nodiscard]] std::string scan_message(const std::vector<frames::ScanPoint>& points, std::int64_t utime);

}  // namespace curbstone::viewer::foxglove
