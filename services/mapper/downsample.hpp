#pragma once

#include <vector>

#include "services/mapper/revolution.hpp"

namespace curbstone {

/// Thins a cloud to one point a voxel, the first that came, keeping the order. Points farther than `max_range` from the
/// origin are left out.
[[nodiscard]] std::vector<LidarPoint> downsample(const std::vector<LidarPoint>& points, double voxel, double max_range);

}  // namespace curbstone
