#include <algorithm>

#include "services/mapper/registration/shape_map.hpp"

/// @file
/// ShapeLevel: its voxels for a file, and from there.

namespace curbstone::mapper::registration {

void ShapeLevel::note_changes() {
  notes_changes_ = true;
  changed_.clear();
  changed_.reserve(size());
  index_.for_each([&](const Eigen::Vector3i& cell, std::uint32_t voxel) {
    moments_[voxel].is_noted = true;
    changed_.push_back(cell);
  });
}

std::vector<VoxelSums> ShapeLevel::take_changed(std::size_t most) {
  const auto end = changed_.begin() + static_cast<std::ptrdiff_t>(std::min(most, changed_.size()));
  std::vector<VoxelSums> taken;
  taken.reserve(static_cast<std::size_t>(end - changed_.begin()));
  for (auto cell = changed_.begin(); cell != end; ++cell) {
    const std::uint32_t voxel = index_.find(*cell);
    if (voxel == voxels::BlockIndex::kNone) continue;
    Moments& m = moments_[voxel];
    m.is_noted = false;
    VoxelSums& out = taken.emplace_back();
    out.cell = {cell->x(), cell->y(), cell->z()};
    for (int i = 0; i < 4; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out.sums[k] = m.first[i];
      out.sums[k + 4] = m.squares[i];
      out.sums[k + 8] = m.rest[i];
    }
    out.sums[12] = m.rays_z;
  }
  changed_.erase(changed_.begin(), end);
  return taken;
}

void ShapeLevel::restore(std::span<const VoxelSums> voxels) {
  for (const VoxelSums& in : voxels) {
    std::uint32_t& voxel = index_.place({in.cell[0], in.cell[1], in.cell[2]});
    if (voxel == voxels::BlockIndex::kNone) voxel = new_voxel();
    Moments& m = moments_[voxel];
    m.first = Eigen::Array4f(in.sums[0], in.sums[1], in.sums[2], in.sums[3]);
    m.squares = Eigen::Array4f(in.sums[4], in.sums[5], in.sums[6], in.sums[7]);
    m.rest = Eigen::Array4f(in.sums[8], in.sums[9], in.sums[10], in.sums[11]);
    m.rays_z = in.sums[12];
  }
  notes_changes_ = true;
  end_insertion();
}

}  // namespace curbstone::mapper::registration
