#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "services/localizer/fields/field_tile.hpp"
#include "services/localizer/fields/paint_field.hpp"

namespace curbstone::localizer::fields {

/// The part of a tile that the search of the whole map uses; kept for each tile, 160 bytes.
struct TilePlan {
  std::bitset<semantic_map::tile::kCellsInTile> standing;  ///< the cell holds an upright structure
  std::bitset<semantic_map::tile::kCellsInTile> ground;    ///< the cell shows ground with its height
};

/// Reads a tile of the map from storage; returns nothing if the tile is missing or cannot be read.
using TileSource = std::function<std::optional<semantic_map::tile::MapTile>(TileKey)>;

/// The saved map as the localizer uses it, in m in that map. Tiles are read, and fields made, when they are first
/// needed. A bounded number of those around the latest query is kept. Results are a function of the tiles alone. One
/// thread.
class SavedMap {
 public:
  /// Bound on tiles, and on fields: at most 95 MB together; enough for a dozen places of a search.
  static constexpr std::size_t kMaxKept = 8000;
  static constexpr double kWindow = 75.0;  ///< m around the latest query: tiles farther away are evicted first

  /// Reads each tile once, for its plan. An exception of `source` propagates from this call; later `source` must not
  /// throw.
  SavedMap(const std::vector<TileKey>& keys, TileSource source);
  /// A map that is entirely in memory.
  explicit SavedMap(const std::vector<semantic_map::tile::MapTile>& tiles);

  struct Ground {
    double height = 0;                                ///< m
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the height over x and y
    bool by_curb = false;                             ///< the map has a curb within 0.6 m
  };
  /// The ground between four cells that all show ground; nothing elsewhere.
  [[nodiscard]] std::optional<Ground> ground_at(double x, double y);
  /// The approximate ground height, from the tile as a whole. NaN where the map shows no ground.
  [[nodiscard]] double level_at(double x, double y);

  struct UprightThere {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< zero: not a line
  };
  /// The nearest upright structure within about 0.6 m.
  [[nodiscard]] std::optional<UprightThere> upright_at(double x, double y);
  /// The road markings; none before they are set.
  [[nodiscard]] const PaintField& paint() const { return paint_; }
  void set_paint(PaintField paint) { paint_ = std::move(paint); }
  [[nodiscard]] std::size_t num_tiles() const { return plans_.size(); }
  [[nodiscard]] std::vector<TileKey> keys() const;  ///< in order
  /// The plan of a tile; null if the map has no such tile.
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
  PaintField paint_;
  std::unordered_map<TileKey, TilePlan, TileKeyHash> plans_;
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles_;  // nothing: the tile could not be read
  std::size_t unreadable_ = 0;
  std::unordered_map<TileKey, std::unique_ptr<const FieldTile>, TileKeyHash> fields_;
  // For each tile position modulo kAround, the field used last: a revolution queries the same few hundred fields
  // repeatedly, in no particular order.
  static constexpr int kAround = 32;
  struct Asked {
    std::optional<TileKey> key;
    const FieldTile* field = nullptr;
  };
  std::array<Asked, std::size_t{kAround} * kAround> asked_;
};

}  // namespace curbstone::localizer::fields
