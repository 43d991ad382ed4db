#include "services/semantic_map/cells/cell_classes.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>

namespace curbstone::semantic_map::cells {

namespace {

constexpr int kVehicleReach = 5;      // cells: 1.3 m square
constexpr int kVehicleCells = 10;     // high cells in it, for a vehicle or a piece of wall
constexpr double kReachesTop = 0.85;  // of the vehicle's height
constexpr int kShadow = 8;            // cells: about as far as an edge hides what is behind and below it
constexpr double kSlope = 0.15;       // slope that unseen ground may have
constexpr double kCurbLink = 0.45;    // m: cells between curb points this close are curb, too

/// The cells of a tile and of its neighbours, up to kReach cells beyond the tile.
class ColumnWindow {
 public:
  explicit ColumnWindow(const tile::Around<CellColumns>& columns) {
    // Tile by tile, a row's part at a time.
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const CellColumns* tile = columns.at(dx, dy);
        if (tile == nullptr) continue;
        const int first = dx < 0 ? kCellsPerTile - kReach : 0;
        const int num = dx == 0 ? kCellsPerTile : kReach;
        const int row_end = dy > 0 ? kReach : kCellsPerTile;
        for (int row = dy < 0 ? kCellsPerTile - kReach : 0; row < row_end; ++row) {
          const CellColumn* const from = &tile->at(first, row);
          const CellColumn** const to = &cells_[index(first + dx * kCellsPerTile, row + dy * kCellsPerTile)];
          for (int i = 0; i < num; ++i) to[i] = from + i;
        }
      }
    }
  }
  /// Whether heights that ground_beyond() can find may differ by more than `limit`, m. `known`: some of the heights.
  [[nodiscard]] bool has_relief(double limit, Extent known) const {
    for (std::size_t i = 0; i < cells_.size() && known.size() <= limit; ++i) {
      if (cells_[i] != nullptr && cells_[i]->shows_ground()) known.take(cells_[i]->ground_z);
    }
    return known.size() > limit;
  }
  /// nullptr where there is no tile. Up to kReach cells beyond the tile.
  [[nodiscard]] const CellColumn* at(int column, int row) const { return cells_[index(column, row)]; }

 private:
  static constexpr int kReach = std::max({kShadow, kVehicleReach, 1});
  static constexpr int kSize = kCellsPerTile + 2 * kReach;
  static std::size_t index(int column, int row) {
    return static_cast<std::size_t>((row + kReach) * kSize + column + kReach);
  }
  std::array<const CellColumn*, std::size_t{kSize} * kSize> cells_{};
};

/// Cells with points above the ground, and their neighbours.
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

/// The obstacle in a cell, with its neighbours considered: a point just beyond the edge may in fact be on this side of
/// it, and a single point counts if there are others beside it.
struct Standing {
  bool blocks = false;
  double top = 0;  ///< m above ground
};

Standing standing_at(const ColumnWindow& cells, int column, int row, const ClassParameters& parameters) {
  const CellColumn& cell = *cells.at(column, row);
  if (cell.blocks(parameters)) return {true, double{cell.top}};
  struct Side {
    int dx, dy;
    std::size_t edge;  // edge of the neighbour that adjoins this cell
  };
  int over_the_edge = 0;
  for (const Side& side : {Side{-1, 0, 1}, Side{1, 0, 0}, Side{0, -1, 3}, Side{0, 1, 2}}) {
    const CellColumn* next = cells.at(column + side.dx, row + side.dy);
    if (next != nullptr) over_the_edge += next->at_edge[side.edge];
  }
  if (cell.blocking_points + over_the_edge == 0) return {};
  bool supported = false;
  Standing standing;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const CellColumn* next = cells.at(column + dx, row + dy);
      if (next == nullptr) continue;
      supported = supported || next->blocks(parameters);
      standing.top = std::max(standing.top, double{next->top});
    }
  }
  standing.blocks =
      cell.blocking_points + over_the_edge >= parameters.min_points || (cell.blocking_points > 0 && supported);
  return standing;
}

/// Whether the cell is part of an object as high as `min_vehicle` and as large as a piece of a car.
bool is_large(const ColumnWindow& cells, int column, int row, const ClassParameters& parameters) {
  int high = 0;
  for (int r = row - kVehicleReach; r <= row + kVehicleReach; ++r) {
    for (int c = column - kVehicleReach; c <= column + kVehicleReach; ++c) {
      const CellColumn* cell = cells.at(c, r);
      if (cell != nullptr && cell->is_high(parameters)) ++high;
    }
  }
  return high >= kVehicleCells;
}

/// Whether the cell shows a pit, or the far side of a downward edge: its points are below the ground around.
bool is_drop(const CellColumn& cell, const ClassParameters& parameters) {
  return cell.drop_points >= parameters.min_points && 2 * cell.drop_points >= cell.ground_points;
}

double drop_of(const ClassParameters& parameters) {
  return std::max(parameters.min_obstacle, parameters.max_step);
}

/// The nearest ground in a direction from a cell, and its distance in steps.
struct GroundBeyond {
  const CellColumn* cell = nullptr;
  int steps = 0;
};

GroundBeyond ground_beyond(const ColumnWindow& cells, int column, int row, int dx, int dy) {
  for (int k = 1; k <= kShadow; ++k) {
    const CellColumn* cell = cells.at(column + k * dx, row + k * dy);
    if (cell == nullptr) return {};
    if (cell->shows_ground()) return {cell, k};
  }
  return {};
}

/// Whether the cell is unseen between ground at two heights: the edge between them hides it, seen from above.
bool hides_a_drop(const ColumnWindow& cells, int column, int row, const ClassParameters& parameters) {
  constexpr int kDirections[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
  return std::any_of(std::begin(kDirections), std::end(kDirections), [&](const int(&d)[2]) {
    const GroundBeyond a = ground_beyond(cells, column, row, d[0], d[1]);
    if (a.cell == nullptr) return false;
    const GroundBeyond b = ground_beyond(cells, column, row, -d[0], -d[1]);
    if (b.cell == nullptr) return false;
    const double apart = (a.steps + b.steps) * kCellSize * std::hypot(d[0], d[1]);
    return double{std::abs(a.cell->ground_z - b.cell->ground_z)} > drop_of(parameters) + kSlope * apart;
  });
}

/// Inputs for the classes of a tile's cells.
struct TileView {
  const ColumnWindow& cells;
  const VehicleCells& vehicles;
  std::bitset<tile::kCellsInTile> near_standing;
  bool is_flat;  // no drop can be hidden
};

tile::CellClass class_of(const TileView& view, int column, int row, const ClassParameters& parameters) {
  const auto& [cells, vehicles, near_standing, is_flat] = view;
  const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
  const CellColumn& cell = *cells.at(column, row);
  const Standing standing = near_standing[i] ? standing_at(cells, column, row, parameters) : Standing{};
  if (standing.blocks) {
    if (standing.top >= kReachesTop * parameters.vehicle_height || vehicles.beneath[i]) return tile::CellClass::kWall;
    return is_large(cells, column, row, parameters) ? tile::CellClass::kWall : tile::CellClass::kObstacle;
  }
  if (is_drop(cell, parameters)) return tile::CellClass::kObstacle;
  if (cell.ground_points == 0)
    return !is_flat && hides_a_drop(cells, column, row, parameters) ? tile::CellClass::kObstacle
                                                                    : tile::CellClass::kUnknown;
  return vehicles.beneath[i] ? tile::CellClass::kWall : tile::CellClass::kRoad;
}

void mark_curb(const Eigen::Vector2d& at, double height, double confidence, const ClassParameters& parameters,
               tile::MapTile& tile) {
  const int column = static_cast<int>(std::floor(at.x() / kCellSize));
  const int row = static_cast<int>(std::floor(at.y() / kCellSize));
  if (column < 0 || row < 0 || column >= kCellsPerTile || row >= kCellsPerTile) return;
  const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
  if (tile.cell_class[i] == tile::CellClass::kWall || tile.cell_class[i] == tile::CellClass::kObstacle) return;
  tile.cell_class[i] = tile::CellClass::kCurb;
  tile.cost[i] = std::max(tile.cost[i] == 255 ? std::uint8_t{0} : tile.cost[i],
                          traversal_cost(tile::CellClass::kCurb, height, parameters));
  tile.confidence[i] = std::max(tile.confidence[i], static_cast<std::uint8_t>(255 * confidence));
}

/// Marks curb points, and the cells between neighbouring points of one line.
void mark_curbs(const tile::Around<std::vector<curbs::CurbPoint>>& curbs, const ClassParameters& parameters,
                tile::MapTile& tile) {
  struct Placed {
    Eigen::Vector2d at;
    const curbs::CurbPoint* p;
  };
  std::vector<Placed> placed;
  curbs.for_each([&](const std::vector<curbs::CurbPoint>& points, double dx, double dy) {
    for (const curbs::CurbPoint& p : points) {
      const Eigen::Vector2d at = p.foot + Eigen::Vector2d(dx, dy);
      if ((at.array() > -kCurbLink).all() && (at.array() < kTileSize + kCurbLink).all()) placed.push_back({at, &p});
    }
  });
  for (std::size_t i = 0; i < placed.size(); ++i) {
    mark_curb(placed[i].at, placed[i].p->height, placed[i].p->confidence, parameters, tile);
    for (std::size_t j = i + 1; j < placed.size(); ++j) {
      const Eigen::Vector2d d = placed[j].at - placed[i].at;
      if (d.norm() > kCurbLink || placed[i].p->up.dot(placed[j].p->up) < 0.7) continue;
      if (std::abs(d.dot(placed[i].p->up)) > 0.5 * d.norm()) continue;
      const double height = 0.5 * (placed[i].p->height + placed[j].p->height);
      const double confidence = std::min(placed[i].p->confidence, placed[j].p->confidence);
      const int steps = static_cast<int>(d.norm() / (0.5 * kCellSize));
      for (int k = 1; k < steps; ++k) mark_curb(placed[i].at + d * k / steps, height, confidence, parameters, tile);
    }
  }
}

std::int16_t height_steps(float z, float z_origin) {
  const double steps = std::round((double{z} - double{z_origin}) / kPositionStep);
  return static_cast<std::int16_t>(std::clamp(steps, -32767.0, 32767.0));
}

}  // namespace

std::uint8_t traversal_cost(tile::CellClass cell_class, double curb_height, const ClassParameters& parameters) {
  switch (cell_class) {
    case tile::CellClass::kRoad:
      return 0;
    case tile::CellClass::kCurb:
      if (curb_height > parameters.max_step) return 254;
      return static_cast<std::uint8_t>(60 + 140 * curb_height / std::max(parameters.max_step, 1e-3));
    case tile::CellClass::kObstacle:
    case tile::CellClass::kWall:
      return 254;
    case tile::CellClass::kUnknown:
      break;
  }
  return parameters.unknown_is_free ? 0 : 255;
}

void classify_cells(const tile::Around<CellColumns>& columns, const tile::Around<std::vector<curbs::CurbPoint>>& curbs,
                    const VehicleCells& vehicles, const ClassParameters& parameters, tile::MapTile& tile) {
  const ColumnWindow window(columns);
  Extent ground;
  columns.for_each([&](const CellColumns& beside, double, double) { ground.take(beside.ground); });
  const double drop = drop_of(parameters);
  const bool is_flat = ground.size() <= drop || !window.has_relief(drop, columns.centre()->ground);
  const TileView view{window, vehicles, find_near_standing(columns), is_flat};
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
      const CellColumn& cell = columns.centre()->cells[i];
      tile.cell_class[i] = class_of(view, column, row, parameters);
      tile.cost[i] = traversal_cost(tile.cell_class[i], 0, parameters);
      tile.height[i] = cell.points > 0 ? height_steps(cell.ground_z, tile.z_origin) : tile::MapTile::kNoHeight;
      const int support = cell.ground_points + cell.blocking_points + cell.drop_points;
      tile.hits[i] = static_cast<std::uint8_t>(std::min<int>(255, cell.points));
      tile.confidence[i] = tile.cell_class[i] == tile::CellClass::kUnknown
                               ? std::uint8_t{0}
                               : static_cast<std::uint8_t>(std::min(255, 32 * support));
    }
  }
  mark_curbs(curbs, parameters, tile);
}

}  // namespace curbstone::semantic_map::cells
