#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/tiles/tile.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::voting {

/// A point of a tile. Cells are determined from coordinates within the tile, pairs from coordinates in the map.
struct FieldPlace {
  int x;  ///< steps from the tile's corner
  int y;
  int z;  ///< steps, in map
  kernels::StepPoint in_map;

  FieldPlace(TileKey key, std::int32_t z_origin, const TilePoint& point)
      : x(point.x), y(point.y), z(z_origin + point.z), in_map{plus(corner(key.x), x), plus(corner(key.y), y), z} {}
  FieldPlace(TileKey key, const kernels::StepPoint& at)
      : x(plus(at.x, corner(-key.x))), y(plus(at.y, corner(-key.y))), z(at.z), in_map(at) {}

 private:
  /// Wraps for tiles thousands of kilometres away: only differences are used.
  static std::int32_t corner(std::int32_t tile) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(tile) * kStepsPerTile);
  }
  static std::int32_t plus(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
  }
};

/// Index of a cell within its tile; z counts from the map's zero.
struct FieldCell {
  int x;
  int y;
  int z;
  auto operator<=>(const FieldCell&) const = default;
};

/// The division of each tile of a voting field: into voxels, in each of which one point votes, and into cells, which
/// serve to find the voters within reach. All lengths are in steps of kPositionStep.
class FieldGrid {
 public:
  /// Throws std::invalid_argument. Besides the conditions of validate(), `voxel` must be a multiple of kPositionStep
  /// and divide a tile, and `radius` must not exceed a tile.
  explicit FieldGrid(const VotingParameters& parameters);

  [[nodiscard]] bool thins() const { return voxel_ > 0; }
  [[nodiscard]] std::int64_t radius() const { return radius_; }         ///< rounded up
  [[nodiscard]] int cells_per_tile() const { return cells_per_tile_; }  ///< along one side
  [[nodiscard]] std::size_t columns_per_tile() const {
    return static_cast<std::size_t>(cells_per_tile_) * static_cast<std::size_t>(cells_per_tile_);
  }
  [[nodiscard]] int reach() const { return reach_; }  ///< of a vote, in cells

  [[nodiscard]] FieldCell cell_of(const FieldPlace& place) const {
    return {by_cell_.floor(place.x), by_cell_.floor(place.y), by_cell_.floor(place.z)};
  }
  [[nodiscard]] std::size_t column_of(int x, int y) const { return static_cast<std::size_t>(y * cells_per_tile_ + x); }
  [[nodiscard]] std::uint64_t voxel_of(const FieldPlace& place) const;
  /// The gap between the nearest sides of two cells whose indices differ by `d` along one axis.
  [[nodiscard]] std::int64_t gap(int d) const { return std::int64_t{std::max(0, std::abs(d) - 1)} * cell_; }

 private:
  /// Floored division by a constant, as a multiplication.
  class Divisor {
   public:
    explicit Divisor(int by = 1) : inverse_(1.0 / by) {}
    [[nodiscard]] int floor(int v) const {
      const double quotient = (v + 0.5) * inverse_;  // never an integer, so rounding cannot cross one
      const auto towards_zero = static_cast<int>(quotient);
      return towards_zero - (quotient < 0 ? 1 : 0);
    }

   private:
    double inverse_;
  };

  int voxel_ = 0;  // 0: no thinning
  int radius_ = 0;
  int cell_ = 0;  // edge; divides a tile
  int cells_per_tile_ = 0;
  int reach_ = 0;
  Divisor by_voxel_;
  Divisor by_cell_;
};

}  // namespace curbstone::tensor_voting::voting
