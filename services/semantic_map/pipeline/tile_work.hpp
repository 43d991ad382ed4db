#pragma once

#include <cstdint>
#include <limits>
#include <set>

#include "common/tiles/tile.hpp"

namespace curbstone::semantic_map::pipeline {

/// The change of a tile by a step of VOTED_POINTS.
struct VotedChange {
  TileKey key;
  std::int32_t revision = 0;
  std::int64_t utime = 0;  ///< us, of the tile's newest point
  std::size_t points_before = 0;
  std::size_t points = 0;
  double update_cost = 0;  ///< WorkResult::cost of the tile's last update; 0: there was none
};

/// A piece of work on the map.
struct TileWork {
  enum class Kind {
    /// All urgent steps of one tile, from the present results of its neighbours.
    kUpdate,
    /// Columns and classes of one tile, from its present ground and curbs: shows what stands where, at a tenth of the
    /// cost. If the ground has changed since, the columns stay stale.
    kUpdateColumns,
    /// The step that has been stale for longest, of any tile.
    kOldestStep,
  };
  Kind kind = Kind::kOldestStep;
  TileKey key{};  ///< not of kOldestStep

  friend bool operator==(const TileWork&, const TileWork&) = default;
};

/// The result of a piece of work.
struct WorkResult {
  double cost = 0;            ///< counted, not timed; the curb evidence of an average tile costs 1
  std::set<TileKey> changed;  ///< tiles whose classes changed
  bool markings = false;      ///< whether the cells of paint of any tile changed
};

/// Which steps are stale. Each step of a tile that becomes stale gets the next turn.
struct Backlog {
  std::int64_t turn = 0;                                           ///< of the step that became stale last
  std::int64_t oldest = std::numeric_limits<std::int64_t>::max();  ///< of the step that has been stale for longest
};

}  // namespace curbstone::semantic_map::pipeline
