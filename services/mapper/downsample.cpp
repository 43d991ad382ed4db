#include "services/mapper/downsample.hpp"

#include "services/mapper/flat_index.hpp"

namespace curbstone {

std::vector<LidarPoint> downsample(const std::vector<LidarPoint>& points, double voxel, double max_range) {
  const double inverse = 1.0 / voxel;
  const auto max2 = static_cast<float>(max_range * max_range);
  FlatIndex taken(points.size());
  std::vector<LidarPoint> out;
  out.reserve(points.size());
  for (const LidarPoint& point : points) {
    if (point.position.squaredNorm() > max2) continue;
    if (taken.find_or_insert(voxel_key(voxel_of(point.position, inverse)), 0) == FlatIndex::kNone) out.push_back(point);
  }
  return out;
}

}  // namespace curbstone
