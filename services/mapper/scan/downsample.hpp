#pragma once

#include <vector>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// Thins a cloud to one point a voxel, the first that came, keeping the order. Points farther than `max_range` from the
/// origin are left out.
[[nodiscard]] std::vector<LidarPoint> downsample(const std::vector<LidarPoint>& points, double voxel, double max_range);

}  // namespace curbstone::mapper::scan
