#include "services/mapper/dense_tile.hpp"

#include <algorithm>
#include <limits>

namespace curbstone {

std::size_t NumberSet::place_of(std::uint32_t number) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = (number * 0x9e3779b1U >> 7) & mask;
  while (slots_[i] != 0 && slots_[i] != number + 1) i = (i + 1) & mask;
  return i;
}

bool NumberSet::contains(std::uint32_t number) const {
  return !slots_.empty() && slots_[place_of(number)] != 0;
}

void NumberSet::insert(std::uint32_t number) {
  if (2 * (size_ + 1) > slots_.size()) {
    std::vector<std::uint32_t> old(std::max<std::size_t>(64, 2 * slots_.size()));
    old.swap(slots_);
    for (const std::uint32_t slot : old) {
      if (slot != 0) slots_[place_of(slot - 1)] = slot;
    }
  }
  std::uint32_t& slot = slots_[place_of(number)];
  size_ += slot == 0 ? 1 : 0;
  slot = number + 1;
}

DenseTile::DenseTile(std::int32_t z_origin, int voxel_steps) : z_origin_(z_origin), voxel_steps_(voxel_steps) {
  asleep_ = true;
  wake();
}

std::uint32_t DenseTile::voxel_number(const TilePoint& point) const {
  const int per_side = kStepsPerTile / voxel_steps_;
  const int floor_steps = (32768 / voxel_steps_ + 1) * voxel_steps_;  // below every int16, on the lattice through 0
  const int layer = (point.z + floor_steps) / voxel_steps_;
  return static_cast<std::uint32_t>((layer * per_side + point.y / voxel_steps_) * per_side + point.x / voxel_steps_);
}

void DenseTile::append(const TilePoint& point, std::int64_t utime, std::int32_t anchor) {
  constexpr std::int64_t kLongestRun = 1'000'000;  // us: what cut_after() can tell apart
  if (runs_.empty() || runs_.back().anchor != anchor || std::abs(utime - runs_.back().utime) > kLongestRun) {
    runs_.push_back({anchor, static_cast<std::int32_t>(points_.size()), utime});
  }
  utime_ = std::max(utime_, utime);
  points_.push_back(point);
  occupied_.insert(voxel_number(point));
}

std::int64_t DenseTile::cut_after(std::int64_t utime) {
  const std::size_t before = points_.size();
  std::vector<TilePoint> points;
  std::vector<Run> runs;
  points.swap(points_);
  runs.swap(runs_);
  utime_ = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (runs[r].utime > utime) continue;
    const std::size_t end = r + 1 < runs.size() ? static_cast<std::size_t>(runs[r + 1].first) : before;
    runs_.push_back({runs[r].anchor, static_cast<std::int32_t>(points_.size()), runs[r].utime});
    utime_ = std::max(utime_, runs[r].utime);
    points_.insert(points_.end(), points.begin() + runs[r].first, points.begin() + static_cast<std::ptrdiff_t>(end));
  }
  sleep();
  return static_cast<std::int64_t>(before - points_.size());
}

float& DenseTile::lowest(int column, int row) {
  return lowest_[static_cast<std::size_t>(row * kColumns + column)];
}

void DenseTile::sleep() {
  if (asleep_) return;
  asleep_ = true;
  points_.shrink_to_fit();
  occupied_.clear();
  lowest_ = {};
}

void DenseTile::wake() {
  if (!asleep_) return;
  asleep_ = false;
  lowest_.assign(kColumns * kColumns, std::numeric_limits<float>::infinity());
  for (const TilePoint& point : points_) {
    occupied_.insert(voxel_number(point));
    float& low = lowest(point.x * kColumns / kStepsPerTile, point.y * kColumns / kStepsPerTile);
    low = std::min(low, static_cast<float>(z_origin_ + point.z * kPositionStep));
  }
}

}  // namespace curbstone
