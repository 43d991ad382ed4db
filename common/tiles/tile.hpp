#pragma once

#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace curbstone {

/// The plane of the map frame is divided into squares of 3.0 m = 25 x 25 cells of 0.12 m (the paper's resolution).
inline constexpr double kTileSize = 3.0;        ///< m
inline constexpr int kCellsPerTile = 25;        ///< along one side
inline constexpr double kCellSize = 0.12;       ///< m
inline constexpr double kPositionStep = 0.002;  ///< m: the unit of positions inside tile messages
inline constexpr int kStepsPerTile = 1500;      ///< kTileSize / kPositionStep

/// Names a tile: its corner is at (x, y) * kTileSize in map.
struct TileKey {
  std::int32_t x = 0;
  std::int32_t y = 0;
  auto operator<=>(const TileKey&) const = default;
};

struct TileKeyHash {
  std::size_t operator()(const TileKey& key) const noexcept {
    std::uint64_t h =
        (static_cast<std::uint64_t>(static_cast<std::uint32_t>(key.x)) << 32) | static_cast<std::uint32_t>(key.y);
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;  // splitmix64 finaliser
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<std::size_t>(h ^ (h >> 31));
  }
};

/// The tile that holds (x, y), in m in map. Nothing if a coordinate is not finite or exceeds the range of int32.
[[nodiscard]] inline std::optional<TileKey> tile_at(double x, double y) {
  const double tx = std::floor(x / kTileSize);
  const double ty = std::floor(y / kTileSize);
  constexpr double kLimit = 2147483000.0;
  if (!(std::abs(tx) < kLimit && std::abs(ty) < kLimit)) return std::nullopt;
  return TileKey{static_cast<std::int32_t>(tx), static_cast<std::int32_t>(ty)};
}

/// The squared distance from a tile's centre to (x, y), in m in map; m^2.
[[nodiscard]] inline double squared_distance(TileKey key, double x, double y) {
  const double dx = (key.x + 0.5) * kTileSize - x;
  const double dy = (key.y + 0.5) * kTileSize - y;
  return dx * dx + dy * dy;
}

/// A point inside a tile, in units of kPositionStep from the tile's corner and its z_origin. Map points exist in this
/// form only, so every process computes on exactly the same numbers.
struct TilePoint {
  std::int16_t x = 0;  ///< 0 .. kStepsPerTile - 1
  std::int16_t y = 0;
  std::int16_t z = 0;
  std::uint8_t intensity = 0;
  bool operator==(const TilePoint&) const = default;
};

/// The points of a tile are sent as a list of records that only grows. A point is removed by a record with the same y
/// and z and x' = -1 - x. No two points of a tile are at the same place.
[[nodiscard]] constexpr bool is_removal(const TilePoint& record) {
  return record.x < 0;
}
/// The record that removes a point; given such a record, the point.
[[nodiscard]] constexpr TilePoint removal_of(const TilePoint& point) {
  return {static_cast<std::int16_t>(-1 - point.x), point.y, point.z, point.intensity};
}
[[nodiscard]] constexpr bool at_one_place(const TilePoint& a, const TilePoint& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

}  // namespace curbstone
