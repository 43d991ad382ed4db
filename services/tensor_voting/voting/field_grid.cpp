#include "services/tensor_voting/voting/field_grid.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "services/tensor_voting/voting/voxel_table.hpp"

namespace curbstone::tensor_voting::voting {

namespace {

/// The smallest edge (in steps) of cells that tile a tile and span `radius` with `reach` cells.
int smallest_cell(int radius, int reach) {
  for (int n = kStepsPerTile; n > 1; --n) {
    if (kStepsPerTile % n == 0 && reach * (kStepsPerTile / n) >= radius) return kStepsPerTile / n;
  }
  return kStepsPerTile;
}

}  // namespace

FieldGrid::FieldGrid(const VotingParameters& parameters) {
  validate(parameters);
  if (parameters.radius > kTileSize) throw std::invalid_argument("radius: expected at most a tile (3 m)");
  voxel_ = static_cast<int>(std::lround(parameters.voxel / kPositionStep));
  if (std::abs(voxel_ * kPositionStep - parameters.voxel) > 1e-9 || (voxel_ > 0 && kStepsPerTile % voxel_ != 0)) {
    throw std::invalid_argument("voxel = " + std::to_string(parameters.voxel) +
                                ": expected a multiple of 0.002 m that divides 3 m");
  }
  radius_ = static_cast<int>(std::ceil(parameters.radius / kPositionStep - 1e-9));
  // Small cells cause fewer tests of pairs out of reach. But there are few thinned voters, and small cells would leave
  // their blocks half empty; the cost is dominated by memory accesses that bring little.
  cell_ = smallest_cell(radius_, voxel_ > 0 ? 1 : 2);
  cells_per_tile_ = kStepsPerTile / cell_;
  reach_ = (radius_ + cell_ - 1) / cell_;
  by_cell_ = Divisor(cell_);
  if (voxel_ > 0) by_voxel_ = Divisor(voxel_);
}

std::uint64_t FieldGrid::voxel_of(const FieldPlace& place) const {
  return VoxelTable::key(by_voxel_.floor(place.x), by_voxel_.floor(place.y), by_voxel_.floor(place.z));
}

}  // namespace curbstone::tensor_voting::voting
