#pragma once

#include <Eigen/Core>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::localizer::fields {

/// The road markings of the saved map as rectangles of paint, in m in that map. Their ends, of dashes and of stop
/// lines, are all that shows the place along a street without anything upright. Immutable.
class PaintField {
 public:
  static constexpr double kReach = 0.6;  ///< m: paint farther away is ignored

  PaintField() = default;
  /// Pieces with an end that is not finite are left out.
  explicit PaintField(const std::vector<semantic_map::tile::MarkingLine>& lines);

  /// From the nearest paint to the point; zero on paint. Nothing if no paint is in reach.
  [[nodiscard]] std::optional<Eigen::Vector2d> offset_at(double x, double y) const;
  [[nodiscard]] bool empty() const { return by_tile_.empty(); }

 private:
  struct Rectangle {
    Eigen::Vector2d middle, along;  // m in map; unit vector
    double half_length, half_width;
  };
  void add(const Rectangle& rectangle);

  std::unordered_map<TileKey, std::vector<Rectangle>, TileKeyHash> by_tile_;  // in each tile that is in reach
};

}  // namespace curbstone::localizer::fields
