#include "services/mapper/dense_map/tile_mover.hpp"

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

namespace curbstone::mapper::dense_map {

TileMover::TileMover(TileGrid before, std::vector<Pose> corrections, const Eigen::Vector3d& vehicle)
    : before_(std::move(before)), corrections_(std::move(corrections)), left_(before_.keys()) {
  const auto distance = [&](TileKey key) { return squared_distance(key, vehicle.x(), vehicle.y()); };
  std::sort(left_.begin(), left_.end(),
            [&](TileKey a, TileKey b) { return std::tuple(distance(b), b) < std::tuple(distance(a), a); });
}

void TileMover::move(std::size_t most, const std::function<void(const MovedPoint&)>& put) {
  for (std::size_t moved = 0; moved < most && !left_.empty(); left_.pop_back()) moved += move_tile(left_.back(), put);
}

/// The correction of the run's keyframe.
Pose TileMover::correction_of(const DenseTile::Run& run) const {
  const bool moves = run.anchor >= 0 && static_cast<std::size_t>(run.anchor) < corrections_.size();
  return moves ? corrections_[static_cast<std::size_t>(run.anchor)] : Pose::Identity();
}

std::size_t TileMover::move_tile(TileKey key, const std::function<void(const MovedPoint&)>& put) {
  const DenseTile& tile = *before_.find(key);
  const std::shared_ptr<const TileRecords> content = tile.read();
  if (!content) {
    before_.erase(key);
    return 0;
  }
  const std::vector<bool> there = content->standing();
  const Eigen::Vector3d corner = corner_of(key, tile);
  const Eigen::Vector3d half(0.5, 0.5, 0.5);  // a point's coordinates mark the lower corner of its step
  for (std::size_t r = 0; r < content->runs.size(); ++r) {
    const DenseTile::Run& run = content->runs[r];
    const Pose T_new_old = correction_of(run);
    const std::size_t end = content->end_of(r);
    for (auto i = static_cast<std::size_t>(run.first); i < end; ++i) {
      if (!there[i]) continue;
      const TilePoint& p = content->records[i];
      const Eigen::Vector3d was = corner + kPositionStep * (Eigen::Vector3d(p.x, p.y, p.z) + half);
      put({T_new_old * was, tile.z_origin(), p.intensity, run.utime, run.anchor});
    }
  }
  const std::size_t count = tile.num_points();
  before_.erase(key);
  return count;
}

}  // namespace curbstone::mapper::dense_map
