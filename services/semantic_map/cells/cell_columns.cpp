#include "services/semantic_map/cells/cell_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "services/semantic_map/ground/ground_columns.hpp"

namespace curbstone::semantic_map::cells {

namespace {

/// The centre of each cell, m from the tile's corner.
struct CellCentres {
  std::array<double, tile::kCellsInTile> x{}, y{};
  CellCentres() {
    for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
      x[i] = (static_cast<int>(i) % kCellsPerTile + 0.5) * kCellSize;
      y[i] = (static_cast<int>(i) / kCellsPerTile + 0.5) * kCellSize;
    }
  }
};

}  // namespace

ColumnAccumulator::ColumnAccumulator(const ground::GroundSurface& ground, const ClassParameters& parameters)
    : parameters_(parameters), cells_(tile::kCellsInTile) {
  static const CellCentres centres;
  std::array<double, tile::kCellsInTile> heights;
  ground::GroundColumns(ground).heights(centres.x.data(), centres.y.data(), heights.size(), heights.data());
  unread_.set();
  for (std::size_t i = 0; i < heights.size(); ++i) {
    Cell& cell = cells_[i];
    cell.ground = static_cast<float>(heights[i]);
    cell.lowest = std::numeric_limits<float>::infinity();
    if (!std::isnan(heights[i])) continue;
    const auto rough = ground.height_or_rough(centres.x[i], centres.y[i]);
    if (rough) cell.ground = static_cast<float>(*rough);
  }
}

void ColumnAccumulator::add(std::span<const tile::VotedPoints::Place> points) {
  const double drop = std::max(parameters_.min_obstacle, parameters_.max_step);
  for (const tile::VotedPoints::Place& p : points) {
    const int column = std::clamp(static_cast<int>(double{p.x} / kCellSize), 0, kCellsPerTile - 1);
    const int row = std::clamp(static_cast<int>(double{p.y} / kCellSize), 0, kCellsPerTile - 1);
    const auto index = static_cast<std::size_t>(row * kCellsPerTile + column);
    Cell& at = cells_[index];
    CellColumn& cell = at.column;
    if (cell.points == CellColumn::kMaxPoints) continue;
    unread_.set(index);
    ++cell.points;
    at.lowest = std::min(at.lowest, p.z);
    const float above = p.z - at.ground;
    if (double{std::abs(above)} <= parameters_.ground_band) {
      ++cell.ground_points;
      at.ground_sum += double{p.z};
    } else if (double{above} <= -drop) {
      ++cell.drop_points;
    } else if (double{above} >= parameters_.min_obstacle && double{above} <= parameters_.vehicle_height) {
      ++cell.blocking_points;
      const double dx = double{p.x} - column * kCellSize;
      const double dy = double{p.y} - row * kCellSize;
      if (dx < parameters_.margin) ++cell.at_edge[0];
      if (dx > kCellSize - parameters_.margin) ++cell.at_edge[1];
      if (dy < parameters_.margin) ++cell.at_edge[2];
      if (dy > kCellSize - parameters_.margin) ++cell.at_edge[3];
      if (above > at.highest[0]) {
        at.highest[1] = at.highest[0];
        at.highest[0] = above;
      } else {
        at.highest[1] = std::max(at.highest[1], above);
      }
    }
  }
  num_points_ += points.size();
}

bool ColumnAccumulator::read(CellColumns& columns) {
  bool is_other = false;
  for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
    if (!unread_[i]) continue;
    const Cell& from = cells_[i];
    CellColumn cell = from.column;
    cell.ground_z = cell.ground_points > 0 ? static_cast<float>(from.ground_sum / cell.ground_points) : from.lowest;
    cell.top = from.highest[1];
    if (cell == columns.cells[i]) continue;
    is_other = true;
    columns.cells[i] = cell;
    columns.standing.set(i, cell.blocking_points > 0);
    columns.blocked.set(i, cell.blocks(parameters_));
    columns.high.set(i, cell.is_high(parameters_));
  }
  unread_.reset();
  if (!is_other) return false;
  columns.ground = {};
  for (const CellColumn& cell : columns.cells) {
    if (cell.shows_ground()) columns.ground.take(cell.ground_z);
  }
  return true;
}

CellColumns measure_columns(const tile::VotedTile& tile, const ground::GroundSurface& ground,
                            const ClassParameters& parameters) {
  ColumnAccumulator accumulator(ground, parameters);
  accumulator.add(tile.points.places());
  CellColumns columns;
  accumulator.read(columns);
  return columns;
}

}  // namespace curbstone::semantic_map::cells
