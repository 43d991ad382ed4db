#pragma once

#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/viewer/foxglove/point_message.hpp"

namespace curbstone::viewer::foxglove {

/// The mapper's points around the vehicle, from MAP_POINTS. Points that fall out of reach are discarded and are not
/// restored when the vehicle returns: the dense map of an hour is a gigabyte. Pure; one thread.
class NearPoints {
 public:
  static constexpr double kReach = 33;                       ///< m, from the vehicle to the centre of a tile
  static constexpr std::size_t kMaxTilePoints = 16'000;      ///< per tile (9 m^2); later points are dropped
  static constexpr std::size_t kMaxTiles = 600;              ///< more than lie within reach; binds without a pose
  static constexpr std::size_t kMaxMessagePoints = 150'000;  ///< 2.4 MB

  /// False: the message is invalid. Points of an epoch other than the present one are ignored.
  bool put(const map_points_t& message);
  /// Discards everything if `epoch` is not the present one, and all tiles out of reach of (x, y), m in map.
  void look_from(std::int32_t epoch, double x, double y);

  /// Increases with each change.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] std::int64_t utime() const { return utime_; }  ///< us, of the newest revolution included
  /// m in map; evenly thinned to kMaxMessagePoints.
  [[nodiscard]] std::vector<CloudPoint> points() const;

 private:
  struct Tile {
    double z_origin = 0;
    std::int64_t next = 0;  // index of the first record not received yet
    std::vector<TilePoint> points;
  };
  static void apply(const map_points_t& message, Tile& tile);

  std::int32_t epoch_ = -1;
  std::uint64_t number_ = 0;
  std::int64_t utime_ = 0;
  std::map<TileKey, Tile> tiles_;
};

}  // namespace curbstone::viewer::foxglove
