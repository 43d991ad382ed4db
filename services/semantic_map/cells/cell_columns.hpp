#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/config/config.hpp"
#include "services/semantic_map/ground/ground_model.hpp"
#include "services/semantic_map/tile/map_types.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::cells {

/// Parameters of the cell classes.
struct ClassParameters {
  double ground_band = 0.20;     ///< m around the ground: points in it are ground (pavement and curb included)
  double min_obstacle = 0.22;    ///< m above ground
  double vehicle_height = 2.00;  ///< m; from the vehicle's section
  double min_vehicle = 0.90;     ///< m: an object of this height and of the size of a car is classified as wall
  int min_points = 2;            ///< in a cell and at its edges, to be an obstacle
  double margin = 0.02;          ///< m: a point so close to an edge may belong to the next cell: twice its error
  bool unknown_is_free = false;  ///< the paper's policy; the safe one is the default
  double max_step = 0.15;        ///< m the vehicle may climb

  void visit(ConfigVisitor& v) {
    v.field("ground_band", ground_band, {0.02, 1}, "m around the ground within which points are ground");
    v.field("min_obstacle", min_obstacle, {0.02, 1}, "m above ground from which on a point is an obstacle");
    v.field("min_vehicle", min_vehicle, {0.2, 3}, "m, height from which on a large object is a vehicle or wall");
    v.field("min_points", min_points, {1, 100}, "points in a cell and at its edges, to be an obstacle");
    v.field("margin", margin, {0, 0.06}, "m: a point so close to an edge may belong to the next cell");
    v.field("unknown_is_free", unknown_is_free, "unknown cells cost 0 (the paper's policy; not safe)");
    v.field("max_step", max_step, {0, 0.5}, "m, the highest curb that the vehicle may climb");
  }
};

/// Statistics of the points of one 0.12 m cell, by height above the ground; if there are more than kMaxPoints, of the
/// first ones.
struct CellColumn {
  static constexpr int kMaxPoints = 60'000;
  std::uint16_t points = 0;  ///< all points, including those neither on the ground nor in the way
  std::uint16_t ground_points = 0;
  float ground_z = 0;                 ///< m in map, mean of the ground points; without any: of the lowest point
  std::uint16_t blocking_points = 0;  ///< between min_obstacle and the vehicle's height
  std::uint16_t drop_points = 0;      ///< farther below the ground than an obstacle stands above it, and than max_step
  float top = 0;  ///< m above ground, of the blocking points (the second highest: one may be a stray)
  /// Blocking points within the margin of the cell's edges: towards -x, +x, -y, +y.
  std::array<std::uint16_t, 4> at_edge{};
  [[nodiscard]] bool blocks(const ClassParameters& parameters) const {
    return blocking_points >= parameters.min_points;
  }
  [[nodiscard]] bool is_high(const ClassParameters& parameters) const {
    return blocks(parameters) && double{top} >= parameters.min_vehicle;
  }
  /// Nothing stands there, and the ground does not drop away.
  [[nodiscard]] bool is_clear() const { return blocking_points == 0 && drop_points == 0; }
  /// More than a stray point, which does not make a cell ground yet.
  [[nodiscard]] bool shows_ground() const { return ground_points > 1; }
  bool operator==(const CellColumn&) const = default;
};

/// From the lowest to the highest of some numbers.
struct Extent {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
  void take(const Extent& other) { low = std::min(low, other.low), high = std::max(high, other.high); }
  void take(float value) { take(Extent{value, value}); }
  /// 0 if empty.
  [[nodiscard]] double size() const { return high >= low ? double{high} - double{low} : 0; }
  bool operator==(const Extent&) const = default;
};

/// The columns of a tile, and which of its cells hold something above the ground.
struct CellColumns {
  std::array<CellColumn, tile::kCellsInTile> cells{};
  std::bitset<tile::kCellsInTile> standing;  ///< cells with any point above the ground
  std::bitset<tile::kCellsInTile> blocked;   ///< cells with enough points for an obstacle
  std::bitset<tile::kCellsInTile> high;      ///< of these, cells as high as `min_vehicle`
  Extent ground;                             ///< m in map, heights of the cells that show ground
  [[nodiscard]] const CellColumn& at(int column, int row) const {
    return cells[static_cast<std::size_t>(row * kCellsPerTile + column)];
  }
  bool operator==(const CellColumns&) const = default;
};

/// Assigns the points of a tile to its columns as they arrive.
class ColumnAccumulator {
 public:
  ColumnAccumulator(const ground::GroundSurface& ground, const ClassParameters& parameters);

  void add(std::span<const tile::VotedPoints::Place> points);
  [[nodiscard]] std::size_t num_points() const { return num_points_; }
  /// Updates columns that this accumulator has read before (any columns at the first call): the result is the same as
  /// if all points so far had come at once. Returns whether the columns changed.
  bool read(CellColumns& columns);

 private:
  struct Cell {
    float ground = 0;  // m in map; NaN: not known
    float lowest = 0;  // m in map
    double ground_sum = 0;
    std::array<float, 2> highest{};  // m above ground, of the blocking points
    CellColumn column;
  };
  ClassParameters parameters_;
  std::vector<Cell> cells_;
  std::bitset<tile::kCellsInTile> unread_;  // cells with new points since read()
  std::size_t num_points_ = 0;
};

/// Measures the columns of all points of a tile at once, as ColumnAccumulator does piece by piece.
[[nodiscard]] CellColumns measure_columns(const tile::VotedTile& tile, const ground::GroundSurface& ground,
                                          const ClassParameters& parameters);

}  // namespace curbstone::semantic_map::cells
