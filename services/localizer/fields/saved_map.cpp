#include "services/localizer/fields/saved_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace curbstone::localizer::fields {
namespace {

/// The corner of a tile, m in map.
Eigen::Vector2d corner_of(TileKey key) {
  return kTileSize * Eigen::Vector2d(key.x, key.y);
}

/// A position in cells from a tile's corner. It is computed ten thousand times a revolution: no division, no call of
/// floor().
struct Place {
  Place(TileKey key, double x, double y)
      : column((x - kTileSize * key.x) * kCellsPerMetre), row((y - kTileSize * key.y) * kCellsPerMetre) {}
  static constexpr double kCellsPerMetre = 1.0 / kCellSize;
  double column, row;

  /// Index of the cell in the tile.
  [[nodiscard]] std::size_t cell() const {
    const int c = std::clamp(static_cast<int>(column), 0, kCellsPerTile - 1);
    const int r = std::clamp(static_cast<int>(row), 0, kCellsPerTile - 1);
    return static_cast<std::size_t>(r * kCellsPerTile + c);
  }
};

TilePlan plan_of(const semantic_map::tile::MapTile& tile) {
  TilePlan plan;
  for (std::size_t cell = 0; cell < semantic_map::tile::kCellsInTile; ++cell) {
    plan.standing[cell] = upright_hits(tile, cell) > 0;
    plan.ground[cell] = shows_ground(tile, cell);
  }
  return plan;
}

}  // namespace

SavedMap::SavedMap(const std::vector<TileKey>& keys, TileSource source) : source_(std::move(source)) {
  plans_.reserve(keys.size());
  for (const TileKey key : keys) {
    if (const auto tile = source_(key)) plans_.emplace(key, plan_of(*tile));
  }
}

SavedMap::SavedMap(const std::vector<semantic_map::tile::MapTile>& tiles) {
  for (const semantic_map::tile::MapTile& tile : tiles) plans_.emplace(tile.key, plan_of(tile));
  auto by_key = std::make_shared<std::unordered_map<TileKey, semantic_map::tile::MapTile, TileKeyHash>>();
  for (const semantic_map::tile::MapTile& tile : tiles) by_key->emplace(tile.key, tile);
  source_ = [by_key](TileKey key) -> Tile {
    const auto there = by_key->find(key);
    return there == by_key->end() ? Tile() : Tile(there->second);
  };
}

std::vector<TileKey> SavedMap::keys() const {
  std::vector<TileKey> keys;
  keys.reserve(plans_.size());
  for (const auto& [key, plan] : plans_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  return keys;
}

const TilePlan* SavedMap::plan(TileKey key) const {
  const auto there = plans_.find(key);
  return there == plans_.end() ? nullptr : &there->second;
}

/// Null if the map has no such tile.
const semantic_map::tile::MapTile* SavedMap::tile(TileKey key) {
  if (!plans_.contains(key)) return nullptr;
  auto kept = tiles_.find(key);
  if (kept == tiles_.end()) {
    kept = tiles_.emplace(key, source_(key)).first;
    if (!kept->second) ++unreadable_;
  }
  return kept->second ? &*kept->second : nullptr;
}

/// Evicts what is far from the tile; if that is not enough, evicts everything.
void SavedMap::make_room(TileKey about) {
  const auto is_far = [&](const auto& entry) {
    constexpr auto kTiles = static_cast<std::int64_t>(kWindow / kTileSize);
    const std::int64_t x = std::int64_t{entry.first.x} - about.x, y = std::int64_t{entry.first.y} - about.y;
    return std::max(std::abs(x), std::abs(y)) > kTiles;
  };
  std::erase_if(tiles_, is_far);
  std::erase_if(fields_, is_far);
  asked_ = {};
  if (kept() < kMaxKept) return;
  tiles_.clear();
  fields_.clear();
}

const FieldTile* SavedMap::field_of(TileKey key) {
  constexpr auto kMask = static_cast<std::uint32_t>(kAround - 1);
  Asked& asked =
      asked_[(static_cast<std::uint32_t>(key.y) & kMask) * kAround + (static_cast<std::uint32_t>(key.x) & kMask)];
  if (asked.key == key) return asked.field;
  const auto known = fields_.find(key);
  const FieldTile* field = known != fields_.end() ? known->second.get() : make_field(key);
  asked = {key, field};
  return field;
}

/// Null if the map has no such tile.
const FieldTile* SavedMap::make_field(TileKey key) {
  if (!plans_.contains(key)) return nullptr;
  if (tiles_.size() + 9 > kMaxKept || fields_.size() >= kMaxKept) make_room(key);
  if (tile(key) == nullptr) return nullptr;
  semantic_map::tile::Around<semantic_map::tile::MapTile> around;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) around.set(dx, dy, tile({key.x + dx, key.y + dy}));
  }
  return fields_.emplace(key, std::make_unique<const FieldTile>(make_field_tile(around))).first->second.get();
}

std::optional<SavedMap::Ground> SavedMap::ground_at(double x, double y) {
  const auto key = tile_at(x, y);
  const FieldTile* field = key ? field_of(*key) : nullptr;
  if (field == nullptr) return std::nullopt;
  const Place place(*key, x, y);
  const double from_column = place.column - 0.5, from_row = place.row - 0.5;  // from the first cell's centre
  const int column = std::clamp(static_cast<int>(from_column + 1) - 1, -1, kCellsPerTile - 1);
  const int row = std::clamp(static_cast<int>(from_row + 1) - 1, -1, kCellsPerTile - 1);
  const double u = from_column - column, v = from_row - row;
  const auto h = [&](int c, int r) { return static_cast<double>(field->height_of(column + c, row + r)); };
  const double a = h(0, 0), b = h(1, 0), c = h(0, 1), d = h(1, 1);
  Ground ground;
  ground.height = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
  if (!std::isfinite(ground.height)) return std::nullopt;
  const Eigen::Vector2d& rise = rise_of(field->rise[place.cell()]);
  const Eigen::Vector2d slope =
      Eigen::Vector2d((1 - v) * (b - a) + v * (d - c), (1 - u) * (c - a) + u * (d - b)) / kCellSize;
  ground.slope = rise * rise.dot(slope);
  ground.by_curb = field->by_curb.test(place.cell());
  return ground;
}

double SavedMap::level_at(double x, double y) {
  const auto key = tile_at(x, y);
  const FieldTile* field = key ? field_of(*key) : nullptr;
  return field == nullptr ? std::numeric_limits<double>::quiet_NaN() : double{field->level};
}

std::optional<SavedMap::UprightThere> SavedMap::upright_at(double x, double y) {
  const auto key = tile_at(x, y);
  const FieldTile* field = key ? field_of(*key) : nullptr;
  if (field == nullptr) return std::nullopt;
  const Eigen::Vector2d corner = corner_of(*key);
  const std::uint16_t nearest = field->nearest[Place(*key, x, y).cell()];
  if (nearest == 0) return std::nullopt;
  const Upright& upright = field->uprights[nearest - 1U];
  return UprightThere{corner + upright.centre.cast<double>(), upright.normal.cast<double>()};
}

}  // namespace curbstone::localizer::fields
