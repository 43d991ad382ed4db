#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::semantic_map::marking_lines {

/// A cell of paint, or of the ground beside it, in the map frame. Small: those of the whole map are linked at once.
struct MapMarkingCell {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< m
  float z = 0;                                   ///< m
  float contrast = 0;                            ///< -255..255, relative to the ground around
  bool is_strong = false;
  bool is_bright = true;   ///< off: bare ground
  std::uint8_t count = 1;  ///< points that the contrast is computed from; 255: or more
  float level = 0;         ///< 0..255, of the ground around
};

/// The cells, searchable by place.
class MarkingField {
 public:
  explicit MarkingField(const std::vector<MapMarkingCell>& cells) : cells_(cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      all_[square(cells[i].at)].push_back(i);
      if (cells[i].is_bright) bright_[square(cells[i].at)].push_back(i);
    }
  }
  [[nodiscard]] const std::vector<MapMarkingCell>& cells() const { return cells_; }

  /// Calls visit(index, offset from `at`) for all bright cells within a square of 2 `reach` about `at`, in an order
  /// that depends on the cells alone.
  template <class Visit>
  void within(const Eigen::Vector2d& at, double reach, Visit visit) const {
    within(bright_, at, reach, visit);
  }
  /// The same, including the cells of bare ground.
  template <class Visit>
  void all_within(const Eigen::Vector2d& at, double reach, Visit visit) const {
    within(all_, at, reach, visit);
  }

 private:
  using Grid = std::unordered_map<TileKey, std::vector<std::size_t>, TileKeyHash>;
  template <class Visit>
  void within(const Grid& grid, const Eigen::Vector2d& at, double reach, Visit& visit) const {
    const TileKey low = square(at.array() - reach);
    const TileKey high = square(at.array() + reach);
    for (std::int32_t x = low.x; x <= high.x; ++x) {
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        const auto it = grid.find({x, y});
        if (it == grid.end()) continue;
        for (const std::size_t i : it->second) {
          const Eigen::Vector2d d = cells_[i].at - at;
          if (std::abs(d.x()) <= reach && std::abs(d.y()) <= reach) visit(i, d);
        }
      }
    }
  }

  static constexpr double kSquare = 0.5;  // m
  static TileKey square(const Eigen::Vector2d& at) {
    return {static_cast<std::int32_t>(std::floor(at.x() / kSquare)),
            static_cast<std::int32_t>(std::floor(at.y() / kSquare))};
  }
  const std::vector<MapMarkingCell>& cells_;
  Grid all_, bright_;
};

}  // namespace curbstone::semantic_map::marking_lines
