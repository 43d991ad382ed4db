#include "tools/export/map_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/tiles/tile.hpp"

namespace curbstone::map_export {

namespace {

bool is_known(const semantic_map::tile::MapTile& tile, std::size_t i) {
  return tile.cell_class[i] != semantic_map::tile::CellClass::kUnknown ||
         tile.height[i] != semantic_map::tile::MapTile::kNoHeight;
}

std::int64_t column_of(const semantic_map::tile::MapTile& tile, std::size_t i) {
  return std::int64_t{tile.key.x} * kCellsPerTile + static_cast<std::int64_t>(i % kCellsPerTile);
}

std::int64_t row_of(const semantic_map::tile::MapTile& tile, std::size_t i) {
  return std::int64_t{tile.key.y} * kCellsPerTile + static_cast<std::int64_t>(i / kCellsPerTile);
}

struct Range {
  std::int64_t low = std::numeric_limits<std::int64_t>::max();
  std::int64_t high = std::numeric_limits<std::int64_t>::min();
  void include(std::int64_t value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] std::int64_t size() const { return high - low + 1; }
};

bool is_ground(const MapGrid& grid, std::size_t i) {
  const semantic_map::tile::CellClass c = grid.cell_class[i];
  return (c == semantic_map::tile::CellClass::kRoad || c == semantic_map::tile::CellClass::kCurb) &&
         std::isfinite(grid.height[i]);
}

}  // namespace

double MapGrid::left() const {
  return static_cast<double>(column0) * kCellSize;
}
double MapGrid::top() const {
  return static_cast<double>(row0 + rows) * kCellSize;
}
double MapGrid::bottom() const {
  return static_cast<double>(row0) * kCellSize;
}

MapGrid make_map_grid(const std::vector<semantic_map::tile::MapTile>& tiles) {
  Range x;
  Range y;
  for (const semantic_map::tile::MapTile& tile : tiles) {
    for (std::size_t i = 0; i < semantic_map::tile::kCellsInTile; ++i) {
      if (!is_known(tile, i)) continue;
      x.include(column_of(tile, i));
      y.include(row_of(tile, i));
    }
  }
  if (x.low > x.high) throw MapGridError("the map is empty: it holds no known cell");
  if (x.size() > kMaxGridCells || y.size() > kMaxGridCells || x.size() > kMaxGridCells / y.size())
    throw MapGridError(fmt::format(
        "the map is {:.0f} x {:.0f} m from edge to edge: more than a raster of {} cells holds; --only "
        "curbs,markings needs none",
        static_cast<double>(x.size()) * kCellSize, static_cast<double>(y.size()) * kCellSize, kMaxGridCells));
  MapGrid grid;
  grid.column0 = x.low;
  grid.row0 = y.low;
  grid.columns = static_cast<int>(x.size());
  grid.rows = static_cast<int>(y.size());
  const auto size = static_cast<std::size_t>(x.size() * y.size());
  grid.cell_class.assign(size, semantic_map::tile::CellClass::kUnknown);
  grid.height.assign(size, std::numeric_limits<float>::quiet_NaN());
  grid.cost.assign(size, 255);
  grid.confidence.assign(size, 0);
  grid.hits.assign(size, 0);
  for (const semantic_map::tile::MapTile& tile : tiles) {
    for (std::size_t i = 0; i < semantic_map::tile::kCellsInTile; ++i) {
      const std::int64_t column = column_of(tile, i) - x.low;
      const std::int64_t row = y.high - row_of(tile, i);
      if (column < 0 || column >= grid.columns || row < 0 || row >= grid.rows) continue;
      const std::size_t k = grid.index(static_cast<int>(column), static_cast<int>(row));
      grid.cell_class[k] = tile.cell_class[i];
      grid.cost[k] = tile.cost[i];
      grid.confidence[k] = tile.confidence[i];
      grid.hits[k] = tile.hits[i];
      if (tile.height[i] != semantic_map::tile::MapTile::kNoHeight)
        grid.height[k] = static_cast<float>(double{tile.z_origin} + tile.height[i] * kPositionStep);
    }
  }
  return grid;
}

std::vector<float> ground_slope(const MapGrid& grid) {
  std::vector<float> slope(grid.height.size(), std::numeric_limits<float>::quiet_NaN());
  for (int row = 1; row + 1 < grid.rows; ++row) {
    for (int column = 1; column + 1 < grid.columns; ++column) {
      std::array<double, 9> z{};
      bool all_ground = true;
      for (int i = 0; i < 9 && all_ground; ++i) {
        const std::size_t k = grid.index(column + i % 3 - 1, row + i / 3 - 1);
        all_ground = is_ground(grid, k);
        z[static_cast<std::size_t>(i)] = double{grid.height[k]};
      }
      if (!all_ground) continue;
      const double dx = (z[2] + 2 * z[5] + z[8]) - (z[0] + 2 * z[3] + z[6]);
      const double dy = (z[0] + 2 * z[1] + z[2]) - (z[6] + 2 * z[7] + z[8]);
      slope[grid.index(column, row)] = static_cast<float>(std::hypot(dx, dy) / (8 * kCellSize));
    }
  }
  return slope;
}

}  // namespace curbstone::map_export
