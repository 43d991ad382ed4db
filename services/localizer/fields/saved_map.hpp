#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "services/localizer/fields/field_tile.hpp"

namespace curbstone::localizer::fields {

/// What of a tile the search of the whole map looks at; kept of each tile, 160 bytes.
struct TilePlan {
  std::bitset<semantic_map::tile::kCellsInTile> standing;  ///< something upright is in the cell
  std::bitset<semantic_map::tile::kCellsInTile> ground;    ///< ground with its height is
};

/// A tile of the map, from where it is kept: nothing if it is gone or cannot be read.
using TileSource = std::function<std::optional<semantic_map::tile::MapTile>(TileKey)>;

/// The saved map as the localizer looks at it, in m in that map. Tiles are read, and fields made, when they are first
/// asked for; those about the place asked for last are kept, within a bound. What is said is a function of the tiles
/// alone. One thread.
class SavedMap {
 public:
  /// Tiles, and as many fields: at most 90 MB; a dozen places of a search.
  static constexpr std::size_t kMostKept = 8000;
  static constexpr double kWindow = 75.0;  ///< m, about the place asked for: what is farther makes room

  /// Reads each tile once, for its plan. What a source throws comes through here; later it must not throw.
  SavedMap(const std::vector<TileKey>& keys, TileSource source);
  /// All in memory.
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
  [[nodiscard]] std::size_t num_tiles() const { return plans_.size(); }
  [[nodiscard]] std::vector<TileKey> keys() const;  ///< in order
  /// Null where the map has none.
  [[nodiscard]] const TilePlan* plan(TileKey key) const;
  [[nodiscard]] std::size_t kept() const { return std::max(tiles_.size(), fields_.size()); }  ///< tiles or fields
  [[nodiscard]] std::size_t unreadable() const { return unreadable_; }  ///< times that a tile was gone when asked for

 private:
  const FieldTile* field_of(TileKey key);
  const FieldTile* make_field(TileKey key);

  using Tile = std::optional<semantic_map::tile::MapTile>;
  const semantic_map::tile::MapTile* tile(TileKey key);
  void make_room(TileKey about);

  TileSource source_;
  std::unordered_map<TileKey, TilePlan, TileKeyHash> plans_;
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles_;  // nothing: it could not be read
  std::size_t unreadable_ = 0;
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
