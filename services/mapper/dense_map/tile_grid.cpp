#include "services/mapper/dense_map/tile_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/mapper/voxels/flat_index.hpp"

namespace curbstone::mapper::dense_map {
namespace {

constexpr int kStepsPerMetre = 500;
static_assert(kStepsPerMetre * kTileSize == kStepsPerTile);

/// Index of the tile that holds a column, by the column's index along an axis.
int tile_of_column(int column) {
  return (column >= 0 ? column : column - (DenseTile::kColumns - 1)) / DenseTile::kColumns;
}

/// Offset in tiles of a place that is less than a tile beyond the border, in kPositionStep from the tile's corner.
int tiles_on(int along) {
  return along < 0 ? -1 : (along >= kStepsPerTile ? 1 : 0);
}

/// Offsets of the 26 neighbours of a voxel, face neighbours first: there a surface continues, and so does its noise.
const std::array<Eigen::Vector3i, 26> kVoxelsAbout = [] {
  std::array<Eigen::Vector3i, 26> steps;
  std::size_t count = 0;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) steps[count++] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
  }
  std::stable_sort(steps.begin(), steps.end(),
                   [](const auto& a, const auto& b) { return a.squaredNorm() < b.squaredNorm(); });
  return steps;
}();

}  // namespace

const DenseTile* TileGrid::find(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second;
}

std::vector<TileKey> TileGrid::keys() const {
  std::vector<TileKey> keys;
  keys.reserve(tiles_.size());
  for (const auto& [key, tile] : tiles_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  return keys;
}

DenseTile* TileGrid::wake(TileKey key) {
  constexpr unsigned kMask = kRecentSide - 1;
  Recent& recent =
      recent_[(static_cast<unsigned>(key.x) & kMask) * kRecentSide + (static_cast<unsigned>(key.y) & kMask)];
  if (recent.tile != nullptr && recent.key == key) return recent.tile;
  const auto it = tiles_.find(key);
  if (it == tiles_.end() || !it->second.wake()) return nullptr;
  recent = {key, &it->second};
  return recent.tile;
}

DenseTile* TileGrid::wake_or_make(TileKey key, std::int32_t z_origin) {
  if (DenseTile* tile = wake(key)) return tile;
  if (!evicted_.empty() && evicted_.contains(key)) return nullptr;
  tiles_.try_emplace(key, z_origin, voxel_steps_);
  return wake(key);
}

void TileGrid::erase(TileKey key) {
  recent_.fill({});
  tiles_.erase(key);
}

void TileGrid::evict(TileKey key) {
  erase(key);
  evicted_.insert(key);
}

void TileGrid::sleep(TileKey key) {
  recent_.fill({});
  const auto it = tiles_.find(key);
  if (it != tiles_.end()) fall_asleep(key, it->second);
}

void TileGrid::fall_asleep(TileKey key, DenseTile& tile) {
  if (tile.asleep()) return;
  tile.sleep();
  in_memory_.push_back(key);
}

void TileGrid::spill(std::size_t share) {
  if (in_memory_.size() <= max_in_memory_) return;
  for (std::size_t left = 1 + (in_memory_.size() - max_in_memory_ - 1) / share; left > 0; --left) {
    const auto it = tiles_.find(in_memory_.front());
    in_memory_.pop_front();
    if (it != tiles_.end()) it->second.spill(*spill_file_);
  }
}

void TileGrid::truncate_after(std::int64_t utime) {
  evicted_.clear();
  recent_.fill({});
  for (auto it = tiles_.begin(); it != tiles_.end();) {
    const bool was_away = it->second.is_spilled();
    if (!it->second.truncate_after(utime)) {
      it = tiles_.erase(it);
      continue;
    }
    if (was_away && !it->second.is_spilled()) in_memory_.push_back(it->first);
    ++it;
  }
}

std::vector<TileKey> TileGrid::sleep_beyond(const Eigen::Vector3d& place, double distance) {
  recent_.fill({});
  std::vector<std::pair<double, TileKey>> far;
  for (auto& [key, tile] : tiles_) {
    tile.allow_retry();
    const double d = distance_of(key, place);
    if (d < distance) continue;
    fall_asleep(key, tile);
    far.emplace_back(d, key);
  }
  std::sort(far.begin(), far.end());
  std::vector<TileKey> keys;
  keys.reserve(far.size());
  for (const auto& [d, key] : far) keys.push_back(key);
  return keys;
}

double TileGrid::lowest_about(const Eigen::Vector3d& point) {
  double lowest = std::numeric_limits<double>::infinity();
  const int west = voxels::floor_to_int(point.x() * DenseTile::kColumnsPerMetre - 0.5);
  const int south = voxels::floor_to_int(point.y() * DenseTile::kColumnsPerMetre - 0.5);
  TileKey last{tile_of_column(west), tile_of_column(south)};
  DenseTile* tile = wake(last);
  const int x = west - last.x * DenseTile::kColumns, y = south - last.y * DenseTile::kColumns;
  if (x + 1 < DenseTile::kColumns && y + 1 < DenseTile::kColumns) {  // all four in one tile, as most are
    if (tile == nullptr) return lowest;
    return static_cast<double>(
        std::min({tile->lowest(x, y), tile->lowest(x + 1, y), tile->lowest(x, y + 1), tile->lowest(x + 1, y + 1)}));
  }
  for (int i = 0; i < 4; ++i) {
    const int column = west + (i & 1), row = south + (i >> 1);
    const TileKey key{tile_of_column(column), tile_of_column(row)};
    if (key != last) tile = wake(key);
    last = key;
    if (tile == nullptr) continue;
    const float low = tile->lowest(column - key.x * DenseTile::kColumns, row - key.y * DenseTile::kColumns);
    lowest = std::min(lowest, static_cast<double>(low));
  }
  return lowest;
}

bool TileGrid::known_beside(TileKey key, const DenseTile& tile, const TilePoint& point) {
  if (!tile.has_slept()) return false;
  for (const Eigen::Vector3i& step : kVoxelsAbout) {
    const Eigen::Vector3i at = Eigen::Vector3i(point.x, point.y, point.z) + voxel_steps_ * step;
    const int east = tiles_on(at.x()), north = tiles_on(at.y());
    const bool is_here = east == 0 && north == 0;
    const DenseTile* const there = is_here ? &tile : wake({key.x + east, key.y + north});
    if (there == nullptr) continue;
    const int z = at.z() + (tile.z_origin() - there->z_origin()) * kStepsPerMetre;
    if (std::abs(z) > std::numeric_limits<std::int16_t>::max()) continue;
    const TilePoint beside{static_cast<std::int16_t>(at.x() - east * kStepsPerTile),
                           static_cast<std::int16_t>(at.y() - north * kStepsPerTile), static_cast<std::int16_t>(z), 0};
    if (there->was_occupied(there->voxel_number(beside))) return true;
  }
  return false;
}

}  // namespace curbstone::mapper::dense_map
