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

/// A point of a tile. Cells are found by coordinates within the tile, pairs by coordinates in the map.
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
  /// Wraps for tiles thousands of kilometres away: only differences count.
  static std::int32_t corner(std::int32_t tile) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(tile) * kStepsPerTile);
  }
  static std::int32_t plus(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
  }
};

/// Of a cell within its tile; z counts from the map's zero.
struct FieldCell {
  int x;
  int y;
  int z;
  auto operator<=>(const FieldCell&) const = default;
};

/// How a voting field divides each tile: into voxels, of which one point votes, and into cells, by which the voters
/// within reach are found. All lengths are in steps of kPositionStep.
class FieldGrid {
 public:
  /// Throws std::invalid_argument: besides validate(), `voxel` must be a whole number of kPositionStep and divide a
  /// tile, and `radius` must not exceed a tile.
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
  /// Between the nearest sides of two cells whose indices differ by `d` along one axis.
  [[nodiscard]] std::int64_t gap(int d) const { return std::int64_t{std::max(0, std::abs(d) - 1)} * cell_; }

 private:
  /// Floored division by one number, again and again: a multiplication.
  class Divisor {
   public:
    explicit Divisor(int by = 1) : inverse_(1.0 / by) {}
    [[nodiscard]] int floor(int v) const {
      const double quotient = (v + 0.5) * inverse_;  // never a whole number, so that rounding cannot cross one
      const auto towards_zero = static_cast<int>(quotient);
      return towards_zero - (quotient < 0 ? 1 : 0);
    }

   private:
    double inverse_;
  };

  int voxel_ = 0;  // 0: no thinning
  int radius_ = 0;
  int cell_ = 0;  // edge; a whole number of them makes a tile
  int cells_per_tile_ = 0;
  int reach_ = 0;
  Divisor by_voxel_;
  Divisor by_cell_;
};

}  // namespace curbstone::tensor_voting::voting
