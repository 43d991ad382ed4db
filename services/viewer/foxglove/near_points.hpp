#pragma once

#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/viewer/foxglove/point_message.hpp"

namespace curbstone::viewer::foxglove {

/// The mapper's points about the vehicle, from MAP_POINTS. What the vehicle leaves behind is forgotten, and does not
/// come back when it returns: the dense map of an hour is a gigabyte. Pure; one thread.
class NearPoints {
 public:
  static constexpr double kReach = 33;                       ///< m, from the vehicle to the middle of a tile
  static constexpr std::size_t kMaxTilePoints = 16'000;      ///< of 9 m^2; what comes after is left out
  static constexpr std::size_t kMaxTiles = 600;              ///< while no place is known: more than lie within reach
  static constexpr std::size_t kMaxMessagePoints = 150'000;  ///< 2.4 MB

  /// False: it is not sound. Points of another epoch than the present one are left out.
  bool put(const map_points_t& message);
  /// Forgets everything unless `epoch` is the present one, and what is out of reach of (x, y), m in map.
  void look_from(std::int32_t epoch, double x, double y);

  /// Grows with each change.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] std::int64_t utime() const { return utime_; }  ///< us, of the newest revolution in it
  /// m in map; evenly thinned where there are more than a message takes.
  [[nodiscard]] std::vector<CloudPoint> points() const;

 private:
  struct Tile {
    double z_origin = 0;
    std::int64_t next = 0;  // index of the first record that did not come yet
    std::vector<TilePoint> points;
  };
  static void apply(const map_points_t& message, Tile& tile);

  std::int32_t epoch_ = -1;
  std::uint64_t number_ = 0;
  std::int64_t utime_ = 0;
  std::map<TileKey, Tile> tiles_;
};

}  // namespace curbstone::viewer::foxglove
