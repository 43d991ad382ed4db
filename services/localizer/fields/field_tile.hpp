#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::localizer::fields {

/// A piece of something upright, as the cells about it show it: where it is to a fraction of a cell, and which way it
/// faces. What is no line (a pole, a corner) has no normal.
struct Upright {
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();  ///< m from the tile's corner
  Eigen::Vector2f normal = Eigen::Vector2f::Zero();  ///< unit; zero: no line
  [[nodiscard]] bool is_line() const { return !normal.isZero(); }
};

/// What a tile of the saved map says to a LiDAR: heights of the ground to interpolate between, and for each place the
/// nearest piece of what stands upright.
struct FieldTile {
  static constexpr int kSide = kCellsPerTile + 2;  ///< with one cell of each neighbour
  static constexpr int kReach = 5;                 ///< cells: what stands farther away is not asked for

  /// m in map, at the cells' middles: (column, row) = (-1, -1) first; NaN: no ground was seen
  std::array<float, std::size_t{kSide} * kSide> height{};
  float level = 0;  ///< m in map, median of the heights; NaN: none
  std::array<std::uint16_t, semantic_map::tile::kCellsInTile> nearest{};  ///< 1 + index of uprights; 0: none in reach
  std::vector<Upright> uprights;
  std::bitset<semantic_map::tile::kCellsInTile> by_curb;  ///< a cell of a curb is in reach

  [[nodiscard]] float height_of(int column, int row) const {
    return height[static_cast<std::size_t>((row + 1) * kSide + column + 1)];
  }
};

/// Whether a cell of the map shows ground with its height; how often something upright was seen there, 0: nothing is.
[[nodiscard]] bool shows_ground(const semantic_map::tile::MapTile& tile, std::size_t cell);
[[nodiscard]] int upright_hits(const semantic_map::tile::MapTile& tile, std::size_t cell);

/// Pure. The centre tile must be there.
[[nodiscard]] FieldTile make_field_tile(const semantic_map::tile::Around<semantic_map::tile::MapTile>& tiles);

}  // namespace curbstone::localizer::fields
