#pragma once

#include <curbstone/voted_points_t.hpp>
#include <map>
#include <optional>
#include <vector>

#include "common/counters.hpp"
#include "services/semantic_map/voted_tile.hpp"

namespace curbstone {

/// Puts the pages of VOTED_POINTS together. A revision is taken when all its points are there, in whatever order its
/// pages come; pages of an older revision than the one in the making, and pages that arrive twice, change nothing.
class VotedTileAssembler {
 public:
  static constexpr std::int32_t kMaxPoints = 400'000;  ///< of a tile; more is no tile
  static constexpr std::size_t kMaxUnfinished = 2000;  ///< tiles in the making; the one that waits longest goes first

  /// The revision that this page completes, if it does. Bad pages are refused and counted.
  [[nodiscard]] std::optional<VotedTile> add(const voted_points_t& page, Counters& counters);
  void clear() { unfinished_.clear(); }

 private:
  struct Unfinished {
    VotedTile tile;
    std::vector<bool> have;
    std::int32_t missing = 0;
    std::int64_t turn = 0;
  };
  void drop_oldest(Counters& counters);
  std::map<TileKey, Unfinished> unfinished_;
  std::int64_t turn_ = 0;
};

}  // namespace curbstone
