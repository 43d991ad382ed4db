#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/dense_tile.hpp"

namespace curbstone::mapper::dense_map {

/// Origin of the points of a tile, m in map.
[[nodiscard]] inline Eigen::Vector3d corner_of(TileKey key, const DenseTile& tile) {
  return {key.x * kTileSize, key.y * kTileSize, static_cast<double>(tile.z_origin())};
}

/// Horizontal distance of a tile's centre from a place, m.
[[nodiscard]] inline double distance_of(TileKey key, const Eigen::Vector3d& place) {
  return std::hypot((key.x + 0.5) * kTileSize - place.x(), (key.y + 0.5) * kTileSize - place.y());
}

/// The tiles of the dense map, and queries across their borders. Tiles far from the vehicle sleep, and the records of
/// those that have slept for longest are spilled to a file: see spill(). Access for a change wakes a tile. A tile
/// that the file cannot return cannot be changed; after sleep_beyond() it is tried again. An evicted tile does not
/// begin again: see evict(). One thread.
class TileGrid {
 public:
  /// `voxel_steps`: as for DenseTile; `spill_file`: file for spilled records; `max_in_memory`: sleeping tiles whose
  /// records stay in memory.
  TileGrid(int voxel_steps, std::shared_ptr<SpillFile> spill_file, std::size_t max_in_memory)
      : voxel_steps_(voxel_steps), spill_file_(std::move(spill_file)), max_in_memory_(max_in_memory) {}

  /// The tile in its current state; nullptr if there is none.
  [[nodiscard]] const DenseTile* find(TileKey key) const;
  /// Keys of all tiles, in order.
  [[nodiscard]] std::vector<TileKey> keys() const;

  /// Wakes a tile; nullptr if there is none, or if the file cannot return it.
  [[nodiscard]] DenseTile* wake(TileKey key);
  /// Wakes a tile, or creates it with this z_origin. nullptr if the file cannot return it, or if it was evicted.
  [[nodiscard]] DenseTile* wake_or_make(TileKey key, std::int32_t z_origin);
  void erase(TileKey key);
  /// Drops a tile that subscribers keep as they have it: it cannot be created again before truncate_after(), as other
  /// records with the same numbers would contradict theirs.
  void evict(TileKey key);
  [[nodiscard]] const std::unordered_set<TileKey, TileKeyHash>& evicted() const { return evicted_; }
  /// Does nothing if there is no such tile.
  void sleep(TileKey key);
  /// Puts tiles to sleep whose centre is `distance` m or more from a place (map). Returns them, the nearest first.
  std::vector<TileKey> sleep_beyond(const Eigen::Vector3d& place, double distance);
  /// Calls visit(tile) for every tile, asleep or not.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [key, tile] : tiles_) visit(tile);
  }
  /// Calls DenseTile::truncate_after() on every tile. Tiles that the file cannot return are deleted, and evicted ones
  /// forgotten: subscribers begin anew.
  void truncate_after(std::int64_t utime);

  /// Spills records of the tiles that have slept for longest, which frees most of their memory: one in `share` of the
  /// sleeping tiles with records in memory. The newest ones are kept, so that tiles that come and go at the rim cost
  /// nothing.
  void spill(std::size_t share);

  /// The lowest known height in the four columns around a point (m, map); +infinity if there is none.
  [[nodiscard]] double lowest_about(const Eigen::Vector3d& point);
  /// Whether one of the 26 voxels around a point of a tile was occupied before this visit.
  [[nodiscard]] bool known_beside(TileKey key, const DenseTile& tile, const TilePoint& point);

 private:
  /// Cache of recent look-ups, by the low bits of the tiles' keys: points come tile by tile.
  struct Recent {
    TileKey key;
    DenseTile* tile = nullptr;
  };
  static constexpr int kRecentSide = 16;
  using Tiles = std::unordered_map<TileKey, DenseTile, TileKeyHash>;
  void fall_asleep(TileKey key, DenseTile& tile);

  int voxel_steps_;
  std::shared_ptr<SpillFile> spill_file_;
  std::size_t max_in_memory_;
  Tiles tiles_;
  std::unordered_set<TileKey, TileKeyHash> evicted_;
  std::deque<TileKey> in_memory_;  // sleeping tiles with records in memory, the longest asleep first; may list tiles
                                   // that are awake or gone
  std::array<Recent, std::size_t{kRecentSide} * kRecentSide> recent_;
};

}  // namespace curbstone::mapper::dense_map
