#pragma once

#include <vector>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// Downsamples a cloud to one point per voxel, the first one, keeping the order. Points farther than `max_range` from
/// the origin are left out.
[[nodiscard]] std::vector<LidarPoint> downsample(const std::vector<LidarPoint>& points, double voxel, double max_range);

}  // namespace curbstone::mapper::scan
