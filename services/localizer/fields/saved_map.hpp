#pragma once

#include <array>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "services/localizer/fields/field_tile.hpp"

namespace curbstone::localizer::fields {

/// The saved map as the localizer looks at it, in m in that map. Fields are made when a tile is first asked for, and
/// kept within a bound. What is said is a function of the tiles alone. One thread.
class SavedMap {
 public:
  static constexpr std::size_t kMostFields = 8000;  ///< tiles: some 60 MB

  explicit SavedMap(const std::vector<semantic_map::tile::MapTile>& tiles);

  struct Ground {
    double height = 0;                                ///< m
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the height over x and y
    bool by_curb = false;                             ///< the map has a curb within 0.6 m
  };
  /// Between four cells that all show ground; else nothing.
  [[nodiscard]] std::optional<Ground> ground_at(double x, double y);
  /// About how high the ground is, from the tile as a whole. NaN where the map shows none.
  [[nodiscard]] double level_at(double x, double y);

  struct UprightThere {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< zero: no line
  };
  /// The nearest within 0.6 m, about.
  [[nodiscard]] std::optional<UprightThere> upright_at(double x, double y);
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  [[nodiscard]] std::vector<TileKey> keys() const;  ///< in order
  /// Null where the map has none.
  [[nodiscard]] const semantic_map::tile::MapTile* tile(TileKey key) const;

 private:
  const FieldTile* field_of(TileKey key);
  const FieldTile* make_field(TileKey key);

  std::unordered_map<TileKey, semantic_map::tile::MapTile, TileKeyHash> tiles_;
  std::unordered_map<TileKey, std::unique_ptr<const FieldTile>, TileKeyHash> fields_;
  // Of each place modulo kAround tiles, the field that was asked for last: a revolution asks for the same few hundred
  // again and again, in no order.
  static constexpr int kAround = 32;
  struct Asked {
    std::optional<TileKey> key;
    const FieldTile* field = nullptr;
  };
  std::array<Asked, std::size_t{kAround} * kAround> asked_;
};

}  // namespace curbstone::localizer::fields
