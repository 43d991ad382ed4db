#pragma once

#include <array>
#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <map>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::viewer::store {

/// The dense cloud around some places, thinned to one point per voxel of 0.1 m. It is filled by MAP_POINTS and by
/// VOTED_POINTS, which have the saliencies too: a tile of these takes no more MAP_POINTS. It is for the eye: messages
/// may be missing, and what they bring is shown without it. Each change has a number, and a point keeps that of its
/// last change. Bounded. Pure; one thread.
class DenseCloud {
 public:
  static constexpr int kVoxel = 50;                    ///< steps of kPositionStep: 0.1 m
  static constexpr std::size_t kMaxTilePoints = 1500;  ///< of a tile; the ground alone has 900
  static constexpr std::size_t kMaxTiles = 600;        ///< 30 MB
  static constexpr double kReach = 33;                 ///< m, around the vehicle
  static constexpr double kCutReach = 4;               ///< m, around a cross-section: from a tile's centre

  /// As TilePoint, and saliencies: 0 unknown, else 1 .. 255 for the shares 0 .. 1.
  struct Point {
    std::int16_t x = 0, y = 0, z = 0;
    std::uint8_t intensity = 0;
    std::uint8_t surface = 0;  ///< stick
    std::uint8_t line = 0;     ///< plate
    bool operator==(const Point&) const = default;
  };
  struct Slot {
    Point point;
    std::int32_t voter = 0;  // index in the tile's list of the point with its tensor
    std::uint64_t number = 0;
  };
  struct Tile {
    float z_origin = 0;        ///< m in map
    std::uint64_t number = 0;  ///< of the last change
    std::vector<Slot> slots;
    std::int32_t version = 0;  ///< records received without a gap, or the revision
    std::int64_t chain = 0;
    bool is_voted = false;  ///< filled by VOTED_POINTS
    bool is_whole = false;  ///< the same, from the first point on
    std::unordered_map<std::uint32_t, std::uint16_t> by_voxel;
    std::vector<std::array<std::uint8_t, 2>> tensors;  ///< surface and line, by index in the tile's list
  };
  struct Place {
    double x = 0, y = 0;  ///< m in map
    double reach = 0;     ///< m, to the centre of a tile
  };

  /// Discards everything if `epoch` is not the present one, else all tiles that are near none of the places; returns
  /// which.
  std::vector<TileKey> look(std::int32_t epoch, std::vector<Place> places);
  void clear();
  [[nodiscard]] bool is_near(TileKey key) const;

  enum class Put {
    kTaken,
    kGap,      ///< taken, but earlier messages of the tile are missing
    kIgnored,  ///< of another epoch, known, or more tiles than are kept
    kFar,      ///< near none of the places
    kRefused   ///< invalid
  };
  Put put(const map_points_t& message);
  Put put(const voted_points_t& message);

  [[nodiscard]] const std::map<TileKey, Tile>& tiles() const { return tiles_; }
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }

 private:
  /// Nothing but the reason in `why` if the tile is not to be kept.
  Tile* tile_for(std::int32_t epoch, TileKey key, float z_origin, Put& why);
  void add(Tile& tile, const Point& point, std::int32_t voter);
  void remove(Tile& tile, const TilePoint& gone);
  void take_tensors(Tile& tile, const voted_points_t& message);

  std::int32_t epoch_ = -1;
  std::uint64_t number_ = 0;
  std::vector<Place> places_;
  std::map<TileKey, Tile> tiles_;
};

}  // namespace curbstone::viewer::store
