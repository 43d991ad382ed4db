#include "services/semantic_map/cell_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace curbstone {

CellColumns measure_columns(const VotedTile& tile, const GroundSurface& ground, const ClassParameters& parameters) {
  CellColumns columns;
  const auto nowhere = std::numeric_limits<float>::quiet_NaN();
  std::array<float, kCellsInTile> ground_height;
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const auto height = ground.height_or_rough((column + 0.5) * kCellSize, (row + 0.5) * kCellSize);
      ground_height[static_cast<std::size_t>(row * kCellsPerTile + column)] =
          height ? static_cast<float>(*height) : nowhere;
    }
  }
  const double drop = std::max(parameters.min_obstacle, parameters.max_step);
  std::array<float, kCellsInTile> lowest;
  lowest.fill(std::numeric_limits<float>::infinity());
  std::array<double, kCellsInTile> ground_sum{};
  std::array<std::array<float, 2>, kCellsInTile> highest{};  // of the blocking points
  for (const VotedPoint& p : tile.points) {
    const int column = std::clamp(static_cast<int>(double{p.x} / kCellSize), 0, kCellsPerTile - 1);
    const int row = std::clamp(static_cast<int>(double{p.y} / kCellSize), 0, kCellsPerTile - 1);
    const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
    CellColumn& cell = columns.cells[i];
    ++cell.points;
    lowest[i] = std::min(lowest[i], p.z);
    const float above = p.z - ground_height[i];
    if (double{std::abs(above)} <= parameters.ground_band) {
      ++cell.ground_points;
      ground_sum[i] += double{p.z};
    } else if (double{above} <= -drop) {
      ++cell.drop_points;
    } else if (double{above} >= parameters.min_obstacle && double{above} <= parameters.vehicle_height) {
      cell.bottom = cell.blocking_points == 0 ? above : std::min(cell.bottom, above);
      ++cell.blocking_points;
      const double dx = double{p.x} - column * kCellSize;
      const double dy = double{p.y} - row * kCellSize;
      if (dx < parameters.margin) ++cell.at_edge[0];
      if (dx > kCellSize - parameters.margin) ++cell.at_edge[1];
      if (dy < parameters.margin) ++cell.at_edge[2];
      if (dy > kCellSize - parameters.margin) ++cell.at_edge[3];
      if (above > highest[i][0]) {
        highest[i][1] = highest[i][0];
        highest[i][0] = above;
      } else {
        highest[i][1] = std::max(highest[i][1], above);
      }
    }
  }
  for (std::size_t i = 0; i < kCellsInTile; ++i) {
    CellColumn& cell = columns.cells[i];
    cell.ground_z = cell.ground_points > 0 ? static_cast<float>(ground_sum[i] / cell.ground_points) : lowest[i];
    cell.top = highest[i][1];
    columns.num_blocked += cell.blocks(parameters) ? 1 : 0;
    columns.num_high += cell.is_high(parameters) ? 1 : 0;
  }
  return columns;
}

}  // namespace curbstone
