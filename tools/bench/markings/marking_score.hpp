#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <unordered_set>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "common/tiles/tile.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::bench::markings {

inline constexpr double kTolerance = 0.24;  ///< m: labels are blobs wider than the paint

/// Cells of 0.12 m, column and row from the frame's origin.
using PaintCells = std::unordered_set<TileKey, TileKeyHash>;
[[nodiscard]] TileKey cell_of(const Eigen::Vector2d& at);

/// Cell-wise truth of the paint, without an assignment to lines.
struct PaintTruth {
  PaintCells painted;
  PaintCells judged;  ///< cells with known truth
};

/// A painted band around a polyline. m, the truth's frame.
struct TruePiece {
  std::vector<Eigen::Vector2d> centre;
  double width = 0;
};
struct TrueLine {
  semantic_map::tile::MarkingType type = semantic_map::tile::MarkingType::kUnknown;
  std::vector<TruePiece> pieces;
  std::vector<Eigen::Vector2d> middle = {};  ///< centre line of a double line; counts like either of the two
};

/// Counts of cells; a cell is right if the other side has one within kTolerance.
struct CellScore {
  double found = 0, found_right = 0;  ///< detected as painted, and judged
  double painted = 0, painted_found = 0;
  [[nodiscard]] double precision() const { return found > 0 ? found_right / found : 1; }
  [[nodiscard]] double recall() const { return painted > 0 ? painted_found / painted : 1; }
  [[nodiscard]] double f1() const {
    const double sum = precision() + recall();
    return sum > 0 ? 2 * precision() * recall() / sum : 0;
  }
  void add(const CellScore& other);
};

/// Painted metres, by the true type and the type that was found.
using TypeMetres =
    std::array<std::array<double, semantic_map::tile::kNumMarkingTypes>, semantic_map::tile::kNumMarkingTypes>;

struct LineScore {
  CellScore cells;
  double right_metres = 0;  ///< painted, on paint
  double false_metres = 0;
  double typed_metres = 0;      ///< of the right ones, with the right type
  TypeMetres types{};           ///< of the right ones
  std::vector<double> lateral;  ///< m, one per 0.2 m along solid and dashed lines
  double driven = 0;            ///< m
  [[nodiscard]] double type_share() const { return right_metres > 0 ? typed_metres / right_metres : 0; }
  void add(const LineScore& other);
};

/// The cells that lines cover where they are painted. `T`: to the wanted frame.
[[nodiscard]] PaintCells cells_of(const std::vector<semantic_map::tile::MarkingLine>& lines, const Pose& T);

[[nodiscard]] CellScore score_cells(const PaintCells& found, const PaintTruth& truth);

/// `is_judged`: whether a place, in the truth's frame, was mapped well enough to count.
[[nodiscard]] LineScore score_lines(const std::vector<semantic_map::tile::MarkingLine>& lines, const Pose& T_truth_map,
                                    const std::vector<TrueLine>& truth,
                                    const std::function<bool(const Eigen::Vector2d&)>& is_judged);

}  // namespace curbstone::bench::markings
