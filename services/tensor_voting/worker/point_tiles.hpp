#pragma once

#include <array>
#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <map>
#include <span>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::tensor_voting::worker {

/// A tile of the dense map: its points in the mapper's order, those left out that have been taken out again.
struct PointTile {
  std::int32_t z_origin = 0;  ///< m in map
  std::int64_t utime = 0;     ///< of the newest message that brought records
  std::int32_t records = 0;   ///< points and removals that have come
  std::array<std::int32_t, 9>
      removals{};  ///< of them, by the tile around (row by row) that such a point's votes may reach
  std::vector<TilePoint> points;
};

/// What has arrived of the map of one epoch. Points are only taken when they join on to what is there, so that a tile
/// is always a beginning of the mapper's tile: what was lost between is asked for again (TileFollower).
class PointTiles {
 public:
  struct Limits {
    std::size_t points = 16'000'000;  ///< in all tiles
    std::size_t points_per_tile = 2'000'000;
    std::int32_t key = 1'000'000;  ///< of a tile's x and y: 3000 km
    int reach = kStepsPerTile;     ///< of a vote, in kPositionStep
  };
  explicit PointTiles(Limits limits) : limits_(limits) {}

  enum class Outcome {
    kAdded,
    kDuplicate,  ///< nothing new in it
    kGap,        ///< starts behind the end of what is there
    kRefused,    ///< a position outside its tile, nothing at a removal's place, another z_origin, sizes or keys beyond
                 ///< all reason
    kFull,       ///< one of the limits on points
  };
  struct Taken {
    Outcome outcome;
    std::span<const TilePoint> added;  ///< valid until the next take()
    bool removed = false;              ///< points were taken out: of the tile's points any may be another one
  };
  Taken take(const map_points_t& message);

  void erase(TileKey key);
  void clear();
  [[nodiscard]] const PointTile* find(TileKey key) const;
  [[nodiscard]] const std::map<TileKey, PointTile>& tiles() const { return tiles_; }
  [[nodiscard]] std::size_t num_points() const { return num_points_; }

 private:
  [[nodiscard]] bool plausible(const map_points_t& message) const;
  void count_removal(PointTile& tile, const TilePoint& point) const;

  Limits limits_;
  std::map<TileKey, PointTile> tiles_;
  std::size_t num_points_ = 0;
};

}  // namespace curbstone::tensor_voting::worker
