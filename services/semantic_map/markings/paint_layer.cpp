#include "services/semantic_map/markings/paint_layer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace curbstone::semantic_map::markings {
namespace {

constexpr float kBand = 0.05F;                // m about the ground
constexpr std::uint32_t kMaxPoints = 60'000;  // points of a cell, so that no sum overflows
constexpr int kSteps = kStepsPerTile / kCellsPerTile;

}  // namespace

PaintLayer accumulate_paint(const tile::VotedTile& tile, const ground::GroundSurface& ground) {
  PaintLayer layer;
  if (tile.intensity.size() != tile.points.size()) return layer;
  std::array<float, tile::kCellsInTile> height;
  std::array<bool, tile::kCellsInTile> asked{};
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const std::uint32_t intensity = tile.intensity[i];
    if (intensity == 0) continue;
    const tile::VotedPoints::Place& p = tile.points.places()[i];
    const int x = std::clamp(static_cast<int>(std::lround(double{p.x} / kPositionStep)), 0, kStepsPerTile - 1);
    const int y = std::clamp(static_cast<int>(std::lround(double{p.y} / kPositionStep)), 0, kStepsPerTile - 1);
    const int column = x / kSteps;
    const int row = y / kSteps;
    const auto k = static_cast<std::size_t>(row * kCellsPerTile + column);
    if (!asked[k]) {
      asked[k] = true;
      const auto z = ground.height((column + 0.5) * kCellSize, (row + 0.5) * kCellSize);
      height[k] = z ? static_cast<float>(*z) : std::numeric_limits<float>::quiet_NaN();
    }
    if (!(std::abs(p.z - height[k]) <= kBand)) continue;
    if (layer.cells.empty()) layer.cells.resize(tile::kCellsInTile);
    PaintCell& cell = layer.cells[k];
    if (cell.count == kMaxPoints) continue;
    const auto in_x = static_cast<std::uint32_t>(x - column * kSteps);
    const auto in_y = static_cast<std::uint32_t>(y - row * kSteps);
    ++cell.count;
    cell.sum += intensity;
    cell.squares += intensity * intensity;
    cell.x += in_x;
    cell.y += in_y;
    cell.by_x += in_x * intensity;
    cell.by_y += in_y * intensity;
    cell.z = height[k];
  }
  return layer;
}

}  // namespace curbstone::semantic_map::markings
