#pragma once

#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <map>
#include <span>
#include <vector>

#include "common/tile.hpp"

namespace curbstone {

/// A tile of the dense map: every point of it from the first one on, in the mapper's order.
struct PointTile {
  std::int32_t z_origin = 0;  ///< m in map
  std::int64_t utime = 0;     ///< of the newest message that brought points
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
  };
  explicit PointTiles(Limits limits) : limits_(limits) {}

  enum class Outcome {
    kAdded,
    kDuplicate,  ///< nothing new in it
    kGap,        ///< starts behind the end of what is there
    kRefused,    ///< a position outside its tile, another z_origin, sizes or keys beyond all reason
    kFull,       ///< one of the limits on points
  };
  struct Taken {
    Outcome outcome;
    std::span<const TilePoint> added;  ///< valid until the next take()
  };
  Taken take(const map_points_t& message);

  void erase(TileKey key);
  void clear();
  [[nodiscard]] const PointTile* find(TileKey key) const;
  [[nodiscard]] const std::map<TileKey, PointTile>& tiles() const { return tiles_; }
  [[nodiscard]] std::size_t num_points() const { return num_points_; }

 private:
  [[nodiscard]] bool plausible(const map_points_t& message) const;

  Limits limits_;
  std::map<TileKey, PointTile> tiles_;
  std::size_t num_points_ = 0;
};

}  // namespace curbstone
