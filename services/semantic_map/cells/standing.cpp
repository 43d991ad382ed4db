#include "services/semantic_map/cells/standing.hpp"

#include <algorithm>
#include <cstddef>

namespace curbstone::semantic_map::cells {

namespace {

constexpr double kStrays = 0.03;  // of the points of the fullest cell beside a cell: so few in it are strays
constexpr int kOpenGround = 3;    // points on the ground, for strays above it to be told

/// Index of the neighbour, -1 to 1, in which a column or row lies that is at most a tile's width outside.
constexpr int tile_of(int i) {
  return i < 0 ? -1 : i >= kCellsPerTile ? 1 : 0;
}

/// A cell of a tile or of its neighbours; nullptr where there is no tile.
const CellColumn* cell_at(const tile::Around<CellColumns>& columns, int column, int row) {
  const int dx = tile_of(column);
  const int dy = tile_of(row);
  const CellColumns* tile = columns.at(dx, dy);
  return tile == nullptr ? nullptr : &tile->at(column - dx * kCellsPerTile, row - dy * kCellsPerTile);
}

/// Blocking points just beyond the cell's edges.
int points_over_the_edges(const tile::Around<CellColumns>& columns, int column, int row) {
  struct Side {
    int dx, dy;
    std::size_t edge;  // edge of the neighbour that adjoins this cell
  };
  int points = 0;
  for (const Side& side : {Side{-1, 0, 1}, Side{1, 0, 0}, Side{0, -1, 3}, Side{0, 1, 2}}) {
    const CellColumn* next = cell_at(columns, column + side.dx, row + side.dy);
    if (next != nullptr) points += next->at_edge[side.edge];
  }
  return points;
}

}  // namespace

std::bitset<tile::kCellsInTile> find_near_standing(const tile::Around<CellColumns>& columns) {
  constexpr auto place = [](int column, int row) { return static_cast<std::size_t>(row * kCellsPerTile + column); };
  constexpr int kLast = kCellsPerTile - 1;
  const std::bitset<tile::kCellsInTile>& standing = columns.centre()->standing;
  std::bitset<tile::kCellsInTile> west_column;
  for (int row = 0; row < kCellsPerTile; ++row) west_column.set(place(0, row));
  const std::bitset<tile::kCellsInTile> east_column = west_column << kLast;
  std::bitset<tile::kCellsInTile> near = standing | standing << kCellsPerTile | standing >> kCellsPerTile |
                                         (standing & ~east_column) << 1 | (standing & ~west_column) >> 1;
  const auto look_across = [&](int dx, int dy, auto here, auto there) {
    const CellColumns* tile = columns.at(dx, dy);
    if (tile == nullptr || tile->standing.none()) return;
    for (int i = 0; i < kCellsPerTile; ++i) {
      if (tile->standing[there(i)]) near.set(here(i));
    }
  };
  const auto west = [&](int row) { return place(0, row); };
  const auto east = [&](int row) { return place(kLast, row); };
  const auto south = [&](int column) { return place(column, 0); };
  const auto north = [&](int column) { return place(column, kLast); };
  look_across(-1, 0, west, east);
  look_across(1, 0, east, west);
  look_across(0, -1, south, north);
  look_across(0, 1, north, south);
  return near;
}

Standing standing_at(const tile::Around<CellColumns>& columns, int column, int row, const ClassParameters& parameters) {
  const CellColumn& cell = columns.centre()->at(column, row);
  const int points = cell.blocking_points + points_over_the_edges(columns, column, row);
  if (points == 0) return {};
  bool supported = false;
  int most_beside = 0;
  Standing standing;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const CellColumn* next = cell_at(columns, column + dx, row + dy);
      if (next == nullptr) continue;
      supported = supported || next->blocks(parameters);
      most_beside = std::max(most_beside, int{next->blocking_points});
      standing.top = std::max(standing.top, double{next->top});
    }
  }
  if (cell.ground_points >= kOpenGround && points < kStrays * most_beside) return {};
  if (cell.blocks(parameters)) return {true, double{cell.top}};
  standing.blocks = points >= parameters.min_points || (cell.blocking_points > 0 && supported);
  return standing;
}

}  // namespace curbstone::semantic_map::cells
