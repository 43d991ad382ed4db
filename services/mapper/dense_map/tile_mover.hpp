#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/dense_tile.hpp"
#include "services/mapper/dense_map/tile_grid.hpp"

namespace curbstone::mapper::dense_map {

/// A settled point at its corrected place.
struct MovedPoint {
  Eigen::Vector3d position;    ///< m in map
  std::int32_t z_origin = 0;   ///< of its previous tile
  std::uint8_t intensity = 0;  ///< as in TilePoint
  std::int64_t utime = 0;      ///< us, of its run,
  std::int32_t anchor = 0;     ///< and its keyframe
};

/// Moves the points of a map by the corrections of their keyframes, tile by tile, tiles nearest to the vehicle first.
/// The map of a long drive takes seconds to move, so it is moved in parts, and no pose waits for it. Only one spilled
/// tile at a time is read into memory. One thread.
class TileMover {
 public:
  TileMover() = default;  ///< nothing to move
  /// `before`: the map's tiles; `corrections`: T_new_old by number of the node; `vehicle`: m in map.
  TileMover(TileGrid before, std::vector<Pose> corrections, const Eigen::Vector3d& vehicle);

  [[nodiscard]] bool is_done() const { return left_.empty(); }
  /// Moves whole tiles, until `most` points have gone to `put` or none is left.
  void move(std::size_t most, const std::function<void(const MovedPoint&)>& put);

 private:
  std::size_t move_tile(TileKey key, const std::function<void(const MovedPoint&)>& put);
  [[nodiscard]] Pose correction_of(const DenseTile::Run& run) const;

  TileGrid before_{1, nullptr, 0};
  std::vector<Pose> corrections_;
  std::vector<TileKey> left_;  // the nearest last
};

}  // namespace curbstone::mapper::dense_map
