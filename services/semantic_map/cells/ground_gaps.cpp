#include "services/semantic_map/cells/ground_gaps.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "services/semantic_map/cells/interpolated_road.hpp"

namespace curbstone::semantic_map::cells {

namespace {

constexpr double kMaxGap = 0.61;      // m, from ground to ground: five cells
constexpr int kReach = 4;             // cells, to one side
constexpr double kSameHeight = 0.04;  // m: a difference of this, and
constexpr double kSameSlope = 0.10;   // of this slope more, is no step

struct Cell {
  int column, row;
};
struct Direction {
  int dx, dy;
};
constexpr std::array<Direction, 4> kDirections = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};

/// The ground that was seen in a tile and kReach cells around it, a bit a cell.
class SeenGround {
 public:
  explicit SeenGround(const tile::Around<CellColumns>& columns) : columns_(columns) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (const CellColumns* const tile = columns.at(dx, dy); tile != nullptr) take(*tile, dx, dy);
      }
    }
  }

  /// The cells of a row of the tile in which nothing was seen, that have ground on two opposite sides, and nothing
  /// beside them that stands: the edge of a wall often reaches into the next cell. A bit a column.
  [[nodiscard]] std::uint64_t gaps(int row) const {
    const auto r = static_cast<std::size_t>(row + kReach);
    const std::uint64_t standing = blocked_[r - 1] | blocked_[r] | blocked_[r + 1];
    std::uint64_t between = 0;
    for (const Direction& d : kDirections) between |= with_ground(row, d) & with_ground(row, {-d.dx, -d.dy});
    const std::uint64_t gaps = between & ~seen_[r] & ~(standing | standing << 1 | standing >> 1);
    return gaps >> kReach & ((std::uint64_t{1} << kCellsPerTile) - 1);
  }
  [[nodiscard]] bool is_seen(const Cell& at) const { return is_set(seen_, at); }
  /// Something stands there, or the ground drops away.
  [[nodiscard]] bool is_blocked(const Cell& at) const { return is_set(blocked_, at); }
  /// m in map, of a cell that was seen.
  [[nodiscard]] double height(const Cell& at) const {
    const int dx = tile_of(at.column), dy = tile_of(at.row);
    return double{columns_.at(dx, dy)->at(at.column - dx * kCellsPerTile, at.row - dy * kCellsPerTile).ground_z};
  }

 private:
  static constexpr int kSide = kCellsPerTile + 2 * kReach;
  using Bits = std::array<std::uint64_t, std::size_t{kSide}>;  // by row, from kReach cells below the tile

  static int tile_of(int cell) { return cell < 0 ? -1 : cell < kCellsPerTile ? 0 : 1; }
  static bool is_set(const Bits& bits, const Cell& at) {
    return (bits[static_cast<std::size_t>(at.row + kReach)] >> (at.column + kReach) & 1) != 0;
  }
  void take(const CellColumns& tile, int dx, int dy) {
    const int first = dx < 0 ? kCellsPerTile - kReach : 0;
    const int last = dx > 0 ? kReach : kCellsPerTile;
    const int row_end = dy > 0 ? kReach : kCellsPerTile;
    for (int row = dy < 0 ? kCellsPerTile - kReach : 0; row < row_end; ++row) {
      std::uint64_t seen = 0;
      std::uint64_t blocked = 0;
      for (int column = first; column < last; ++column) {
        const CellColumn& cell = tile.at(column, row);
        const bool is_clear = cell.is_clear();
        seen |= std::uint64_t{is_clear && cell.ground_points > 0} << column;
        blocked |= std::uint64_t{!is_clear} << column;
      }
      const auto r = static_cast<std::size_t>(row + dy * kCellsPerTile + kReach);
      seen_[r] |= moved(seen, dx * kCellsPerTile + kReach);
      blocked_[r] |= moved(blocked, dx * kCellsPerTile + kReach);
    }
  }
  static std::uint64_t moved(std::uint64_t bits, int by) { return by < 0 ? bits >> -by : bits << by; }
  /// The cells of a row from which ground was seen within kReach steps.
  [[nodiscard]] std::uint64_t with_ground(int row, const Direction& d) const {
    std::uint64_t cells = 0;
    for (int k = 1; k <= kReach; ++k)
      cells |= moved(seen_[static_cast<std::size_t>(row + kReach + k * d.dy)], -k * d.dx);
    return cells;
  }

  const tile::Around<CellColumns>& columns_;
  Bits seen_{};
  Bits blocked_{};
};

struct Side {
  double z;   // m in map
  int steps;  // to it
};

/// The ground on one side of a gap.
std::optional<Side> side_of(const SeenGround& ground, const Cell& from, const Direction& d) {
  for (int k = 1; k <= kReach; ++k) {
    const Cell at{from.column + k * d.dx, from.row + k * d.dy};
    if (ground.is_blocked(at)) return std::nullopt;
    if (ground.is_seen(at)) return Side{ground.height(at), k};
  }
  return std::nullopt;
}

/// Height of a cell between ground on both sides, where they are nearest to each other. Nothing if the gap is too wide
/// or may hide a step.
std::optional<double> interpolated(const SeenGround& ground, const Cell& at) {
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
    for (std::uint64_t gaps = ground.gaps(row); gaps != 0; gaps &= gaps - 1) {
      const int column = std::countr_zero(gaps);
      const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
      if (tile.cell_class[i] != tile::CellClass::kUnknown || vehicles.beneath[i]) continue;
      if (const auto z = interpolated(ground, {column, row})) make_interpolated_road(tile, i, z);
    }
  }
}

}  // namespace curbstone::semantic_map::cells
