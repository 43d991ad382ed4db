#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/mapper/dense_map/dense_tile.hpp"

namespace curbstone::mapper::dense_map {

/// Where a tile's points are counted from, m in map.
[[nodiscard]] inline Eigen::Vector3d corner_of(TileKey key, const DenseTile& tile) {
  return {key.x * kTileSize, key.y * kTileSize, static_cast<double>(tile.z_origin())};
}

/// m, in the plane, of a tile's middle from a place.
[[nodiscard]] inline double distance_of(TileKey key, const Eigen::Vector3d& place) {
  return std::hypot((key.x + 0.5) * kTileSize - place.x(), (key.y + 0.5) * kTileSize - place.y());
}

/// The tiles of the dense map, and what lies across their borders. Those far from the vehicle sleep, and the records of
/// those that have slept for longest are away, in a file: see put_away(). Whoever asks for one to change it wakes it. A
/// tile that the file does not give back cannot be changed; sleep_beyond() lets it be tried again. One thread.
class TileGrid {
 public:
  /// `voxel_steps`: as of DenseTile; `far`: where records are put away; `most_here`: tiles that sleep with theirs.
  TileGrid(int voxel_steps, std::shared_ptr<SpillFile> far, std::size_t most_here)
      : voxel_steps_(voxel_steps), far_(std::move(far)), most_here_(most_here) {}

  /// As it is; nullptr if there is none.
  [[nodiscard]] const DenseTile* find(TileKey key) const;
  /// Of all tiles, in order.
  [[nodiscard]] std::vector<TileKey> keys() const;

  /// Awake; nullptr if there is none, or if the file does not give it back.
  [[nodiscard]] DenseTile* wake(TileKey key);
  /// Made if there is none: with this z_origin. nullptr if the file does not give it back.
  [[nodiscard]] DenseTile* wake_or_make(TileKey key, std::int32_t z_origin);
  void erase(TileKey key);
  /// Nothing if there is none.
  void sleep(TileKey key);
  /// Puts those to sleep whose middle is `distance` m from a place (map) and more. They, the nearest first.
  std::vector<TileKey> sleep_beyond(const Eigen::Vector3d& place, double distance);
  /// visit(tile), of every tile, asleep or not.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [key, tile] : tiles_) visit(tile);
  }
  /// DenseTile::cut_after(), of every tile. Those that the file does not give back are no more.
  void cut_after(std::int64_t utime);

  /// Puts records away of tiles that have slept for longest, which saves most of their memory: one in `share` of those
  /// that sleep with their records, but never of the newest ones, so what comes and goes at the rim costs nothing.
  void put_away(std::size_t share);

  /// The lowest height known in the four columns about a point (m, map); +infinity where nothing is.
  [[nodiscard]] double lowest_about(const Eigen::Vector3d& point);
  /// Whether one of the 26 voxels about a point of a tile was occupied before this visit.
  [[nodiscard]] bool known_beside(TileKey key, const DenseTile& tile, const TilePoint& point);

 private:
  /// Tiles looked up lately, by the low bits of their keys: points come tile by tile.
  struct Recent {
    TileKey key;
    DenseTile* tile = nullptr;
  };
  static constexpr int kRecentSide = 16;
  using Tiles = std::unordered_map<TileKey, DenseTile, TileKeyHash>;
  void fall_asleep(TileKey key, DenseTile& tile);

  int voxel_steps_;
  std::shared_ptr<SpillFile> far_;
  std::size_t most_here_;
  Tiles tiles_;
  std::deque<TileKey> here_;  // that sleep with their records, the longest first; some have woken or are gone since
  std::array<Recent, std::size_t{kRecentSide} * kRecentSide> recent_;
};

}  // namespace curbstone::mapper::dense_map
