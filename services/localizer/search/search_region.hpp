#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/localizer/fields/saved_map.hpp"

namespace curbstone::localizer::search {

/// A square of the map in which the vehicle may be, with the upright structures as far around it as the vehicle sees.
/// `upright`: 255 in cells with an upright structure, falling off around them. Level k holds, for each cell, the
/// maximum of the 2^k x 2^k cells that begin at it. This bounds the score of every shift in that range (Olson, ICRA
/// 2009; Hess, Kohler, Rapp, Andor, ICRA 2016). Pure.
class SearchRegion {
 public:
  static constexpr double kCell = 2 * kCellSize;  ///< m
  static constexpr int kLevels = 6;               ///< up to 32 cells, 7.7 m
  static constexpr int kTilesWide = 64;           ///< 192 m
  static constexpr double kSight = 30.0;          ///< m: structures farther from the vehicle are ignored

  /// Regions cover the plane: region (x, y) begins at tile (x, y) * kTilesWide.
  SearchRegion(TileKey region, const fields::SavedMap& map);
  [[nodiscard]] static TileKey region_of(TileKey tile);

  [[nodiscard]] static constexpr int side() { return kWide + 2 * kMargin; }
  [[nodiscard]] static constexpr int wide() { return kWide; }
  /// From cell (x, y) of the region itself, 0 .. wide() - 1.
  [[nodiscard]] const std::uint8_t* upright(int level, int x, int y) const { return at(upright_, level, x, y); }
  /// Whether the vehicle may be in one of the cells that this cell of the level covers: one of them shows road.
  [[nodiscard]] bool drivable(int level, int x, int y) const { return *at(road_, level, x, y) != 0; }
  /// The centre of a cell, m in map.
  [[nodiscard]] Eigen::Vector2d middle(int x, int y) const {
    return corner_ + kCell * Eigen::Vector2d(x + 0.5, y + 0.5);
  }

 private:
  static constexpr int kWide = kTilesWide * kCellsPerTile / 2;
  static constexpr int kMargin = static_cast<int>(kSight / kCell) + (1 << kLevels) + 2;
  using Lattice = std::vector<std::uint8_t>;

  static std::size_t index(int x, int y) { return static_cast<std::size_t>((y + kMargin) * side() + x + kMargin); }
  static const std::uint8_t* at(const std::vector<Lattice>& levels, int level, int x, int y) {
    return &levels[static_cast<std::size_t>(level)][index(x, y)];
  }
  void draw(TileKey tile, const fields::TilePlan& plan, Lattice& standing, Lattice& road) const;

  Eigen::Vector2d corner_;
  std::vector<Lattice> upright_, road_;
};

}  // namespace curbstone::localizer::search
