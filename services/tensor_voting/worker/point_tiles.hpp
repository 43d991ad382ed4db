#pragma once

#include <array>
#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <map>
#include <span>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::tensor_voting::worker {

/// A tile of the dense map: its points in the mapper's order, without the points that were removed.
struct PointTile {
  std::int32_t z_origin = 0;  ///< m in map
  std::int64_t utime = 0;     ///< of the newest message that brought records
  std::int32_t records = 0;   ///< points and removals received
  std::array<std::int32_t, 9>
      removals{};  ///< of them, by the neighbouring tile (row by row) that the removed point's votes may reach
  std::vector<TilePoint> points;
};

/// The received part of the map of one epoch. Points are accepted only if they continue a tile's records, so that a
/// tile is always a prefix of the mapper's tile. Missing records are requested again (TileFollower).
class PointTiles {
 public:
  struct Limits {
    std::size_t points = 16'000'000;  ///< in all tiles
    std::size_t points_per_tile = 2'000'000;
    std::int32_t key = 1'000'000;  ///< magnitude of a tile's x and y: 3000 km
    int reach = kStepsPerTile;     ///< of a vote, in kPositionStep
  };
  explicit PointTiles(Limits limits) : limits_(limits) {}

  enum class Outcome {
    kAdded,
    kDuplicate,  ///< contains nothing new
    kGap,        ///< begins after the end of the known records
    kRefused,    ///< a position outside its tile, nothing at a removal's place, another z_origin, sizes or keys beyond
                 ///< all reason
    kFull,       ///< a limit on points is reached
  };
  struct Taken {
    Outcome outcome;
    std::span<const TilePoint> added;  ///< valid until the next take()
    bool removed = false;              ///< points were removed: any of the tile's points may have changed
  };
  Taken take(const map_points_t& message);

  void erase(TileKey key);
  void clear();
  [[nodiscard]] const PointTile* find(TileKey key) const;
  [[nodiscard]] const std::map<TileKey, PointTile>& tiles() const { return tiles_; }
  [[nodiscard]] std::size_t num_points() const { return num_points_; }

 private:
  [[nodiscard]] bool plausible(const map_points_t& message) const;
  [[nodiscard]] Outcome judge(const map_points_t& message, const PointTile* tile) const;
  [[nodiscard]] bool append(const map_points_t& message, std::size_t begin, PointTile& tile) const;
  void count_removal(PointTile& tile, const TilePoint& point) const;

  Limits limits_;
  std::map<TileKey, PointTile> tiles_;
  std::size_t num_points_ = 0;
};

}  // namespace curbstone::tensor_voting::worker
