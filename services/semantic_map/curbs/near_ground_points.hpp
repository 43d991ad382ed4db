#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "services/semantic_map/ground/ground_columns.hpp"
#include "services/semantic_map/ground/ground_model.hpp"
#include "services/semantic_map/tile/curb_parameters.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::curbs {

/// A point with the tilt of its normal relative to the ground below it.
struct NearGround {
  float x = 0, y = 0;            ///< m from the centre tile's corner
  float tilt_x = 0, tilt_y = 0;  ///< slope of the surface by its normal, relative to the ground's
  bool tilted = false;           ///< the tilt exceeds the scatter of the normals around
  bool is_line = false;          ///< the vote saw little more than a scan line
  bool operator==(const NearGround&) const = default;
};

/// Section VI: the points less than `max_step` (the paper: 0.5 m) above the ground, in a tile and 1.2 m around it. They
/// are sorted into cells of 0.12 m, so that a row of cells is one range. The object keeps its memory, so use one for
/// many tiles.
class NearGroundPoints {
 public:
  static constexpr int kMarginCells = 10;
  static constexpr int kSide = kCellsPerTile + 2 * kMarginCells;  ///< cells
  void gather(const tile::Around<tile::VotedTile>& tiles, const ground::GroundSurface& ground,
              const tile::CurbParameters& parameters);

  /// Number of points gathered, whether near the ground or not.
  [[nodiscard]] std::size_t num_gathered() const { return n_; }
  /// Calls visit(point) for all points in a cell of the tile itself.
  template <class Visit>
  void for_cell(int column, int row, Visit visit) const {
    const auto [begin, end] = range(column, column, row);
    for (std::size_t i = begin; i < end; ++i) visit(described_[i]);
  }
  /// Range [first, second) of the points in the cells of a row, from column0 to column1 inclusive.
  [[nodiscard]] std::pair<std::size_t, std::size_t> range(int column0, int column1, int row) const {
    if (column1 < column0) return {0, 0};
    column0 = std::clamp(column0 + kMarginCells, 0, kSide - 1);
    column1 = std::clamp(column1 + kMarginCells, 0, kSide - 1);
    row = std::clamp(row + kMarginCells, 0, kSide - 1);
    return {static_cast<std::size_t>(start_[static_cast<std::size_t>(row * kSide + column0)]),
            static_cast<std::size_t>(start_[static_cast<std::size_t>(row * kSide + column1) + 1])};
  }
  // All points by columns: x and y in m from the centre tile's corner, z in m above the DEM, `unfit` as in StepWindow.
  // Each column has kPadding more numbers than there are points.
  static constexpr std::size_t kPadding = 8;
  [[nodiscard]] const double* x() const { return x_.data(); }
  [[nodiscard]] const double* y() const { return y_.data(); }
  [[nodiscard]] const double* z() const { return z_.data(); }
  [[nodiscard]] const double* unfit() const { return unfit_.data(); }

 private:
  void find_places(const tile::Around<tile::VotedTile>& tiles);
  void sort(const tile::CurbParameters& parameters);
  void describe(const ground::GroundColumns& ground, const tile::CurbParameters& parameters);

  // All points within the margin, in the order of the tiles; n_ of them.
  std::size_t n_ = 0;
  std::vector<double> at_x_, at_y_;  // m from the centre tile's corner
  std::vector<double> at_z_;         // m in map
  std::vector<const tile::VotedTensor*> tensors_;
  std::vector<int> cells_;      // of the points near the ground
  std::vector<double> ground_;  // m in map, height of the ground; NaN: unknown
  // The points near the ground, by cells.
  std::vector<NearGround> described_;  // valid for points of the tile itself only
  std::vector<double> x_, y_, z_, unfit_;
  std::vector<std::uint32_t> near_;  // their indices among all points, in order
  std::vector<int> start_;           // of each cell
  std::vector<int> next_;            // scratch: the next free place in each cell
  // Those of the tile itself, in any order.
  struct Inner {
    std::size_t index;
    const tile::VotedTensor* tensor;
  };
  std::vector<Inner> inner_;
  std::vector<double> inner_x_, inner_y_, slope_x_, slope_y_, noise_;
};

}  // namespace curbstone::semantic_map::curbs
