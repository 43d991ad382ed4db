#include "services/semantic_map/cells/ground_gaps.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "services/semantic_map/cells/interpolated_road.hpp"

namespace curbstone::semantic_map::cells {

namespace {

constexpr double kMaxGap = 0.61;      // m, from ground to ground: five cells
constexpr int kReach = 4;             // cells, to one side
constexpr double kSameHeight = 0.04;  // m: a difference of this, and
constexpr double kSameSlope = 0.10;   // of this slope more, is no step

/// The ground that was seen in a tile and kReach cells around it.
class SeenGround {
 public:
  static constexpr float kVacant = std::numeric_limits<float>::infinity();
  static constexpr float kBlocked = -kVacant;

  explicit SeenGround(const tile::Around<CellColumns>& columns) {
    z_.fill(kVacant);
    for (int row = -kReach; row < kCellsPerTile + kReach; ++row) {
      const int dy = row < 0 ? -1 : row < kCellsPerTile ? 0 : 1;
      for (int column = -kReach; column < kCellsPerTile + kReach; ++column) {
        const int dx = column < 0 ? -1 : column < kCellsPerTile ? 0 : 1;
        const CellColumns* const tile = columns.at(dx, dy);
        if (tile == nullptr) continue;
        z_[index(column, row)] = height_of(tile->at(column - dx * kCellsPerTile, row - dy * kCellsPerTile));
      }
    }
  }
  /// m in map; kVacant where nothing was seen on the ground, kBlocked where something stands or the ground drops away.
  [[nodiscard]] float at(int column, int row) const { return z_[index(column, row)]; }

 private:
  static constexpr int kSide = kCellsPerTile + 2 * kReach;
  static std::size_t index(int column, int row) {
    return static_cast<std::size_t>((row + kReach) * kSide + column + kReach);
  }
  static float height_of(const CellColumn& cell) {
    if (!cell.is_clear()) return kBlocked;
    return cell.ground_points > 0 ? cell.ground_z : kVacant;
  }
  std::array<float, std::size_t{kSide} * kSide> z_;
};

struct Cell {
  int column, row;
};
struct Direction {
  int dx, dy;
};

struct Side {
  double z;   // m in map
  int steps;  // to it
};

/// The ground on one side of a gap.
std::optional<Side> side_of(const SeenGround& ground, const Cell& from, const Direction& d) {
  for (int k = 1; k <= kReach; ++k) {
    const float z = ground.at(from.column + k * d.dx, from.row + k * d.dy);
    if (z == SeenGround::kVacant) continue;
    if (z == SeenGround::kBlocked) return std::nullopt;
    return Side{double{z}, k};
  }
  return std::nullopt;
}

/// Whether anything stands in a cell beside: the edge of a wall often reaches into the next cell.
bool touches_what_stands(const SeenGround& ground, const Cell& at) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (ground.at(at.column + dx, at.row + dy) == SeenGround::kBlocked) return true;
    }
  }
  return false;
}

/// Height of a cell between ground on both sides, where they are nearest to each other. Nothing if the gap is too wide
/// or may hide a step.
std::optional<double> interpolated(const SeenGround& ground, const Cell& at) {
  constexpr std::array<Direction, 4> kDirections = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  std::optional<double> height;
  double narrowest = kMaxGap;
  for (const Direction& d : kDirections) {
    const auto a = side_of(ground, at, d);
    if (!a) continue;
    const auto b = side_of(ground, at, {-d.dx, -d.dy});
    if (!b) continue;
    const double gap = (a->steps + b->steps) * kCellSize * std::hypot(d.dx, d.dy);
    if (gap >= narrowest || std::abs(a->z - b->z) > kSameHeight + kSameSlope * gap) continue;
    narrowest = gap;
    height = (a->z * b->steps + b->z * a->steps) / (a->steps + b->steps);
  }
  return height;
}

}  // namespace

void interpolate_ground(const tile::Around<CellColumns>& columns, const VehicleCells& vehicles, tile::MapTile& tile) {
  const SeenGround ground(columns);
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
      if (tile.cell_class[i] != tile::CellClass::kUnknown || vehicles.beneath[i]) continue;
      if (ground.at(column, row) != SeenGround::kVacant || touches_what_stands(ground, {column, row})) continue;
      if (const auto z = interpolated(ground, {column, row})) make_interpolated_road(tile, i, z);
    }
  }
}

}  // namespace curbstone::semantic_map::cells
