#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/tile/voted_points.hpp"

namespace curbstone::semantic_map::tile {

/// A complete revision of a tile of VOTED_POINTS.
struct VotedTile {
  TileKey key;
  std::int64_t utime = 0;  ///< us, of its newest point
  std::int32_t revision = 0;
  float z_origin = 0;  ///< m in map, a whole number: heights of messages and of map tiles are relative to it
  VotedPoints points;
  /// By point, on one scale for all beams: the road's median is 64, 0 means unknown; empty: all unknown.
  std::vector<std::uint8_t> intensity;
  std::int64_t chain = 0;  ///< of the worker that sent it
};

/// A tile's T and those of its eight neighbours; null where there is none. Everything that the semantic map computes
/// for a tile is a pure function of such a neighbourhood, so the order in which tiles arrive does not matter.
template <class T>
class Around {
 public:
  [[nodiscard]] const T* at(int dx, int dy) const { return tiles_[index(dx, dy)]; }
  void set(int dx, int dy, const T* tile) { tiles_[index(dx, dy)] = tile; }
  [[nodiscard]] const T* centre() const { return at(0, 0); }

  /// Calls visit(tile, x, y) for each tile that exists, with the offset in m of its corner from the centre tile's.
  template <class Visit>
  void for_each(Visit visit) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (at(dx, dy) != nullptr) visit(*at(dx, dy), dx * kTileSize, dy * kTileSize);
      }
    }
  }

 private:
  static std::size_t index(int dx, int dy) { return static_cast<std::size_t>((dy + 1) * 3 + dx + 1); }
  std::array<const T*, 9> tiles_{};
};

}  // namespace curbstone::semantic_map::tile
