#pragma once

#include <cstdint>
#include <limits>
#include <set>

#include "common/tiles/tile.hpp"

namespace curbstone::semantic_map::pipeline {

/// What a step of VOTED_POINTS made of its tile.
struct VotedChange {
  TileKey key;
  std::int32_t revision = 0;
  std::int64_t utime = 0;  ///< us, of the tile's newest point
  std::size_t points_before = 0;
  std::size_t points = 0;
  double update_cost = 0;  ///< WorkResult::cost of its last update; 0: there was none
};

/// A piece of work on the map.
struct TileWork {
  enum class Kind {
    /// All steps of one tile, with what its neighbours have.
    kUpdate,
    /// Columns and classes of one tile, on the ground and with the curbs that it had: what stands where, at a tenth of
    /// the cost. Where the ground has moved since, the columns stay stale.
    kUpdateColumns,
    /// The one step that has been stale for longest, of any tile.
    kOldestStep,
  };
  Kind kind = Kind::kOldestStep;
  TileKey key{};  ///< not of kOldestStep

  friend bool operator==(const TileWork&, const TileWork&) = default;
};

/// What a piece of work came to.
struct WorkResult {
  double cost = 0;            ///< where the curb evidence of a tile counts 1 on average; by what was looked at
  std::set<TileKey> changed;  ///< tiles whose classes became others
  bool markings = false;      ///< whether the paint of any tile did
};

/// What is stale. Each step of a tile that becomes stale takes the next turn.
struct Backlog {
  std::int64_t turn = 0;                                           ///< of what became stale last
  std::int64_t oldest = std::numeric_limits<std::int64_t>::max();  ///< turn of what is stale for longest
};

}  // namespace curbstone::semantic_map::pipeline
