#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::localizer::fields {

/// A piece of an upright structure, estimated from the cells around it: its position at sub-cell resolution and its
/// normal. A structure that is not a line in plan (a pole, a corner) has no normal.
struct Upright {
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();  ///< m from the tile's corner
  Eigen::Vector2f normal = Eigen::Vector2f::Zero();  ///< unit; zero: not a line
  [[nodiscard]] bool is_line() const { return !normal.isZero(); }
};

/// A tile of the saved map, prepared for registration of LiDAR points: ground heights to interpolate between, and for
/// each cell the nearest piece of an upright structure.
struct FieldTile {
  static constexpr int kSide = kCellsPerTile + 2;  ///< with one cell of each neighbour
  static constexpr int kReach = 5;                 ///< cells: structures farther away are ignored

  /// m in map, at the cells' centres: (column, row) = (-1, -1) first; NaN: no ground was seen
  std::array<float, std::size_t{kSide} * kSide> height{};
  float level = 0;  ///< m in map, median of the heights; NaN: none
  /// The axis along which the ground rises, for each cell of an edge: a curb, a ditch, a steep bank. See rise_of(). 0
  /// elsewhere: between the edges the slope is too small to be told from the noise of the heights.
  std::array<std::uint8_t, semantic_map::tile::kCellsInTile> rise{};
  std::array<std::uint16_t, semantic_map::tile::kCellsInTile> nearest{};  ///< 1 + index of uprights; 0: none in reach
  std::vector<Upright> uprights;
  std::bitset<semantic_map::tile::kCellsInTile> by_curb;  ///< a cell of a curb is in reach

  [[nodiscard]] float height_of(int column, int row) const {
    return height[static_cast<std::size_t>((row + 1) * kSide + column + 1)];
  }
};

/// A unit vector along the axis FieldTile::rise; zero for 0.
[[nodiscard]] const Eigen::Vector2d& rise_of(std::uint8_t axis);

/// Whether a cell of the map shows ground with its height. The number of hits on upright structures in a cell; 0: none.
[[nodiscard]] bool shows_ground(const semantic_map::tile::MapTile& tile, std::size_t cell);
[[nodiscard]] int upright_hits(const semantic_map::tile::MapTile& tile, std::size_t cell);

/// Makes the field of the centre tile, which must exist. Pure.
[[nodiscard]] FieldTile make_field_tile(const semantic_map::tile::Around<semantic_map::tile::MapTile>& tiles);

}  // namespace curbstone::localizer::fields
