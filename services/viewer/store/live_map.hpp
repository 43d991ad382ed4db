#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/viewer/store/tile_cells.hpp"

namespace curbstone::viewer::store {

/// The tiles of the present epoch as numbered changes. Each accepted change gets the next number, and a tile keeps the
/// number of its last change: a listener that is complete up to number n lacks exactly the tiles above n, however often
/// they changed. Bounded by kMaxTiles. Pure; one thread.
class LiveMap {
 public:
  static constexpr std::size_t kMaxTiles = 200'000;  ///< as many as semantic_map keeps: 620 MB

  enum class Put { kTaken, kKnown, kFull };

  /// Takes a tile unless the same or a later revision is stored.
  Put put(TileKey key, const TileCells& cells);
  /// Removes all tiles; the numbers continue.
  void clear();

  /// Of the last change; 0: there was none.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] std::size_t size() const { return tiles_.size(); }
  /// Null when there is none.
  [[nodiscard]] const TileCells* at(TileKey key) const;

  struct Change {
    std::uint64_t number = 0;
    TileKey key;
    const TileCells* cells = nullptr;  ///< valid until the next put() or clear()
  };
  /// The tiles whose last change is above `number`, lowest number first, `max_tiles` at most.
  [[nodiscard]] std::vector<Change> above(std::uint64_t number, std::size_t max_tiles) const;

 private:
  struct Entry {
    std::uint64_t number = 0;
    TileCells cells;
  };
  std::uint64_t number_ = 0;
  std::unordered_map<TileKey, Entry, TileKeyHash> tiles_;
  std::map<std::uint64_t, TileKey> by_number_;
};

}  // namespace curbstone::viewer::store
