#include "services/semantic_map/cells/cell_classes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "services/semantic_map/cells/ground_gaps.hpp"
#include "services/semantic_map/cells/standing.hpp"
#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::cells {

namespace {

constexpr int kVehicleReach = 5;      // cells: 1.3 m square
constexpr int kVehicleCells = 10;     // high cells in it, for a vehicle or a piece of wall
constexpr double kReachesTop = 0.85;  // of the vehicle's height
constexpr int kShadow = 8;            // cells: about the length of the shadow behind and below an edge
constexpr double kSlope = 0.15;       // slope that unseen ground may have
constexpr double kCurbLink = 0.45;    // m: cells between curb points this close are curb, too

/// Heights of the ground in the cells of a tile and up to kShadow cells beyond it.
class GroundWindow {
 public:
  static constexpr float kNotSeen = std::numeric_limits<float>::infinity();
  explicit GroundWindow(const tile::Around<CellColumns>& columns) {
    z_.fill(std::numeric_limits<float>::quiet_NaN());
    // Tile by tile, and in each tile row by row.
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const CellColumns* tile = columns.at(dx, dy);
        if (tile == nullptr) continue;
        const int first = dx < 0 ? kCellsPerTile - kShadow : 0;
        const int num = dx == 0 ? kCellsPerTile : kShadow;
        const int row_end = dy > 0 ? kShadow : kCellsPerTile;
        for (int row = dy < 0 ? kCellsPerTile - kShadow : 0; row < row_end; ++row) {
          const CellColumn* const from = &tile->at(first, row);
          float* const to = &z_[index(first + dx * kCellsPerTile, row + dy * kCellsPerTile)];
          for (int i = 0; i < num; ++i) take(from[i], to[i]);
        }
      }
    }
  }
  /// Largest difference of the heights that ground_beyond() can find, m.
  [[nodiscard]] double relief() const { return heights_.size(); }
  /// m in map; kNotSeen where no ground was seen; NaN where there is no tile.
  [[nodiscard]] float at(int column, int row) const { return z_[index(column, row)]; }

 private:
  static constexpr int kSize = kCellsPerTile + 2 * kShadow;
  static std::size_t index(int column, int row) {
    return static_cast<std::size_t>((row + kShadow) * kSize + column + kShadow);
  }
  /// Without branches, because they would be mispredicted.
  void take(const CellColumn& cell, float& z) {
    const float height = cell.ground_z;
    const bool is_seen = cell.shows_ground();
    z = is_seen ? height : kNotSeen;
    heights_.low = std::min(heights_.low, z);
    heights_.high = std::max(heights_.high, is_seen ? height : -kNotSeen);
  }
  std::array<float, std::size_t{kSize} * kSize> z_;
  Extent heights_;
};

/// The cells as high as `min_vehicle` of a tile and up to kVehicleReach cells around it, a bit each.
class HighCells {
 public:
  explicit HighCells(const tile::Around<CellColumns>& columns) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const CellColumns* tile = columns.at(dx, dy);
        if (tile == nullptr) continue;
        for (std::size_t i = tile->high._Find_first(); i < tile::kCellsInTile; i = tile->high._Find_next(i)) {
          const int column = static_cast<int>(i) % kCellsPerTile + dx * kCellsPerTile + kVehicleReach;
          const int row = static_cast<int>(i) / kCellsPerTile + dy * kCellsPerTile + kVehicleReach;
          if (column < 0 || row < 0 || column >= kSide || row >= kSide) continue;
          rows_[static_cast<std::size_t>(row)] |= std::uint64_t{1} << column;
        }
      }
    }
  }
  /// Whether the cell is part of an object as high as `min_vehicle` and as large as a piece of a car.
  [[nodiscard]] bool are_large(int column, int row) const {
    constexpr int kWidth = 2 * kVehicleReach + 1;
    int high = 0;
    for (int r = row; r < row + kWidth; ++r)
      high += std::popcount((rows_[static_cast<std::size_t>(r)] >> column) & ((std::uint64_t{1} << kWidth) - 1));
    return high >= kVehicleCells;
  }

 private:
  static constexpr int kSide = kCellsPerTile + 2 * kVehicleReach;
  std::array<std::uint64_t, std::size_t{kSide}> rows_{};
};

/// Whether the cell shows a pit, or the far side of a downward edge: its points are below the ground around.
bool is_drop(const CellColumn& cell, const ClassParameters& parameters) {
  return cell.drop_points >= parameters.min_points && 2 * cell.drop_points >= cell.ground_points;
}

double drop_of(const ClassParameters& parameters) {
  return std::max(parameters.min_obstacle, parameters.max_step);
}

/// The nearest ground in a direction from a cell, and its distance in steps.
struct GroundBeyond {
  float z = 0;    // m in map
  int steps = 0;  // 0: there is none
};

GroundBeyond ground_beyond(const GroundWindow& ground, int column, int row, int dx, int dy) {
  for (int k = 1; k <= kShadow; ++k) {
    const float z = ground.at(column + k * dx, row + k * dy);
    if (std::isnan(z)) return {};
    if (z < GroundWindow::kNotSeen) return {z, k};
  }
  return {};
}

/// Whether the cell is unseen between ground at two heights: the edge between them hides it, seen from above.
bool hides_a_drop(const GroundWindow& ground, int column, int row, const ClassParameters& parameters) {
  constexpr int kDirections[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
  return std::any_of(std::begin(kDirections), std::end(kDirections), [&](const int(&d)[2]) {
    const GroundBeyond a = ground_beyond(ground, column, row, d[0], d[1]);
    if (a.steps == 0) return false;
    const GroundBeyond b = ground_beyond(ground, column, row, -d[0], -d[1]);
    if (b.steps == 0) return false;
    const double apart = (a.steps + b.steps) * kCellSize * std::hypot(d[0], d[1]);
    return double{std::abs(a.z - b.z)} > drop_of(parameters) + kSlope * apart;
  });
}

/// Inputs for the classes of a tile's cells.
struct TileView {
  const tile::Around<CellColumns>& columns;
  const HighCells& high;
  const VehicleCells& vehicles;
  const std::optional<GroundWindow>& ground;  // nothing where no drop can be hidden
  std::bitset<tile::kCellsInTile> near_standing;
};

tile::CellClass class_of(const TileView& view, int column, int row, const ClassParameters& parameters) {
  const auto& [columns, high, vehicles, ground, near_standing] = view;
  const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
  const CellColumn& cell = columns.centre()->cells[i];
  const Standing standing = near_standing[i] ? standing_at(columns, column, row, parameters) : Standing{};
  if (standing.blocks) {
    if (standing.top >= kReachesTop * parameters.vehicle_height || vehicles.beneath[i]) return tile::CellClass::kWall;
    return high.are_large(column, row) ? tile::CellClass::kWall : tile::CellClass::kObstacle;
  }
  if (is_drop(cell, parameters)) return tile::CellClass::kObstacle;
  if (cell.ground_points == 0)
    return ground && hides_a_drop(*ground, column, row, parameters) ? tile::CellClass::kObstacle
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

/// std::round() without a call, for values that fit into 32 bits: half away from zero.
[[gnu::always_inline]] inline double rounded(double value) {
  constexpr double kBelowHalf = 0.49999999999999994;  // with 0.5, a value just below a half would become 1
  return static_cast<double>(static_cast<std::int32_t>(value < 0 ? value - kBelowHalf : value + kBelowHalf));
}

/// Everything of a cell that does not depend on the cells around.
CURBSTONE_VECTORISED
void measure_cells(const CellColumn* cells, double z_origin, tile::MapTile& tile) {
  constexpr double kMost = 32767;
  for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
    const CellColumn& cell = cells[i];
    const double exact = (double{cell.ground_z} - z_origin) / kPositionStep;
    const double steps = rounded(exact < -kMost ? -kMost : exact > kMost ? kMost : exact);
    tile.height[i] = cell.points > 0 ? static_cast<std::int16_t>(steps) : tile::MapTile::kNoHeight;
    tile.hits[i] = static_cast<std::uint8_t>(cell.points < 255 ? cell.points : 255);
    const int support = 32 * (cell.ground_points + cell.blocking_points + cell.drop_points);
    tile.confidence[i] = static_cast<std::uint8_t>(support < 255 ? support : 255);
  }
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
  Extent heights;
  columns.for_each([&](const CellColumns& beside, double, double) { heights.take(beside.ground); });
  std::optional<GroundWindow> ground;
  if (heights.size() > drop_of(parameters)) {
    ground.emplace(columns);
    if (ground->relief() <= drop_of(parameters)) ground.reset();
  }
  const HighCells high(columns);
  const TileView view{columns, high, vehicles, ground, find_near_standing(columns)};
  measure_cells(columns.centre()->cells.data(), double{tile.z_origin}, tile);
  std::array<std::uint8_t, tile::kNumClasses> cost;
  for (std::size_t c = 0; c < cost.size(); ++c)
    cost[c] = traversal_cost(static_cast<tile::CellClass>(c), 0, parameters);
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
      const tile::CellClass cell_class = class_of(view, column, row, parameters);
      tile.cell_class[i] = cell_class;
      tile.cost[i] = cost[static_cast<std::size_t>(cell_class)];
      if (cell_class == tile::CellClass::kUnknown) tile.confidence[i] = 0;
    }
  }
  mark_curbs(curbs, parameters, tile);
  interpolate_ground(columns, vehicles, tile);
}

}  // namespace curbstone::semantic_map::cells
