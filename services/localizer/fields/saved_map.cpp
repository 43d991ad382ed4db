#include "services/localizer/fields/saved_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curbstone::localizer::fields {
namespace {

/// m from a tile's corner.
Eigen::Vector2d corner_of(TileKey key) {
  return kTileSize * Eigen::Vector2d(key.x, key.y);
}

/// Cells from a tile's corner. This is asked for ten thousand times a revolution: no division, no call of floor().
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

}  // namespace

SavedMap::SavedMap(const std::vector<semantic_map::tile::MapTile>& tiles) {
  tiles_.reserve(tiles.size());
  for (const semantic_map::tile::MapTile& tile : tiles) tiles_.emplace(tile.key, tile);
}

std::vector<TileKey> SavedMap::keys() const {
  std::vector<TileKey> keys;
  keys.reserve(tiles_.size());
  for (const auto& [key, tile] : tiles_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  return keys;
}

const semantic_map::tile::MapTile* SavedMap::tile(TileKey key) const {
  const auto there = tiles_.find(key);
  return there == tiles_.end() ? nullptr : &there->second;
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

/// Null where the map has no such tile.
const FieldTile* SavedMap::make_field(TileKey key) {
  if (!tiles_.contains(key)) return nullptr;
  semantic_map::tile::Around<semantic_map::tile::MapTile> around;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) around.set(dx, dy, tile({key.x + dx, key.y + dy}));
  }
  if (fields_.size() >= kMostFields) {
    fields_.clear();
    asked_ = {};
  }
  return fields_.emplace(key, std::make_unique<const FieldTile>(make_field_tile(around))).first->second.get();
}

std::optional<SavedMap::Ground> SavedMap::ground_at(double x, double y) {
  const auto key = tile_at(x, y);
  const FieldTile* field = key ? field_of(*key) : nullptr;
  if (field == nullptr) return std::nullopt;
  const Place place(*key, x, y);
  const double from_column = place.column - 0.5, from_row = place.row - 0.5;  // from the first cell's middle
  const int column = std::clamp(static_cast<int>(from_column + 1) - 1, -1, kCellsPerTile - 1);
  const int row = std::clamp(static_cast<int>(from_row + 1) - 1, -1, kCellsPerTile - 1);
  const double u = from_column - column, v = from_row - row;
  const auto h = [&](int c, int r) { return static_cast<double>(field->height_of(column + c, row + r)); };
  const double a = h(0, 0), b = h(1, 0), c = h(0, 1), d = h(1, 1);
  Ground ground;
  ground.height = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
  if (!std::isfinite(ground.height)) return std::nullopt;
  ground.slope = Eigen::Vector2d((1 - v) * (b - a) + v * (d - c), (1 - u) * (c - a) + u * (d - b)) / kCellSize;
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
