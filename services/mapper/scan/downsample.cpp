#include "services/mapper/scan/downsample.hpp"

#include "services/mapper/voxels/flat_index.hpp"

namespace curbstone::mapper::scan {
namespace {

constexpr voxels::VoxelKey kFree = ~voxels::VoxelKey{0};  // never a key: keys have 63 bits

}  // namespace

std::vector<LidarPoint> downsample(const std::vector<LidarPoint>& points, double voxel, double max_range) {
  const double inverse = 1.0 / voxel;
  const auto max2 = static_cast<float>(max_range * max_range);
  std::size_t capacity = 16;
  while (capacity < 2 * points.size()) capacity *= 2;
  std::vector<voxels::VoxelKey> taken(capacity,
                                      kFree);  // open addressing with keys alone: half the size of a FlatIndex
  const auto take = [&](voxels::VoxelKey key) {
    std::size_t i = voxels::FlatIndex::hash(key) & (capacity - 1);
    while (taken[i] != kFree && taken[i] != key) i = (i + 1) & (capacity - 1);
    const bool first = taken[i] == kFree;
    taken[i] = key;
    return first;
  };
  std::vector<LidarPoint> out;
  out.reserve(points.size());
  for (const LidarPoint& point : points) {
    if (point.position.squaredNorm() > max2) continue;
    if (take(voxels::voxel_key(voxels::voxel_of(point.position, inverse)))) out.push_back(point);
  }
  return out;
}

}  // namespace curbstone::mapper::scan
