#include "services/mapper/scan/downsample.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "services/mapper/voxels/flat_index.hpp"

namespace curbstone::mapper::scan {
namespace {

/// A set of keys that are not all ones: open addressing. It holds keys alone, which is half the size of a FlatIndex.
template <class Key>
class KeySet {
 public:
  explicit KeySet(std::size_t expected) {
    while ((std::size_t{1} << bits_) < 2 * expected) ++bits_;
    slots_.assign(std::size_t{1} << bits_, kFree);
  }

  /// Whether the key was not in the set.
  bool insert(Key key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> (64 - bits_));
    while (slots_[i] != kFree && slots_[i] != key) i = (i + 1) & mask;
    const bool is_new = slots_[i] == kFree;
    slots_[i] = key;
    return is_new;
  }

 private:
  static constexpr Key kFree = std::numeric_limits<Key>::max();
  int bits_ = 4;
  std::vector<Key> slots_;
};

template <class Key, class KeyOf>
std::vector<LidarPoint> first_of_each(const std::vector<LidarPoint>& points, double inverse_size, float max_range2,
                                      KeyOf key_of) {
  KeySet<Key> taken(points.size());
  std::vector<LidarPoint> out;
  out.reserve(points.size());
  for (const LidarPoint& point : points) {
    if (point.position.squaredNorm() > max_range2) continue;
    if (taken.insert(key_of(voxels::voxel_of(point.position, inverse_size)))) out.push_back(point);
  }
  return out;
}

}  // namespace

std::vector<LidarPoint> downsample(const std::vector<LidarPoint>& points, double voxel, double max_range) {
  const double inverse = 1.0 / voxel;
  const auto max2 = static_cast<float>(max_range * max_range);
  constexpr double kMaxCells = 1600;  // along an axis, so that their numbers fit into 32 bits
  const double reach = std::ceil(max_range * inverse) + 2;
  if (!(2 * reach <= kMaxCells)) return first_of_each<voxels::VoxelKey>(points, inverse, max2, voxels::voxel_key);
  const auto middle = static_cast<int>(reach);
  const auto side = static_cast<std::uint32_t>(2 * middle);
  return first_of_each<std::uint32_t>(points, inverse, max2, [&](const Eigen::Vector3i& cell) {
    const auto from_edge = [&](int v) { return static_cast<std::uint32_t>(v + middle); };
    return (from_edge(cell.x()) * side + from_edge(cell.y())) * side + from_edge(cell.z());
  });
}

}  // namespace curbstone::mapper::scan
