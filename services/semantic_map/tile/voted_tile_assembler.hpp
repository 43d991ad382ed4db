#pragma once

#include <curbstone/voted_points_t.hpp>
#include <map>
#include <optional>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::tile {

/// All pages of one step of a tile.
struct VotedStep {
  TileKey key;
  std::int64_t chain = 0;
  std::int32_t base = 0;
  std::int32_t revision = 0;
  std::vector<voted_points_t> pages;
};

/// Whether the step continues from `tile`: the tile's revision is the step's base, or a later one in the same chain of
/// steps. A step from nothing always does. nullptr: no tile.
[[nodiscard]] bool continues(const VotedStep& step, const VotedTile* tile);
/// Applies the step to a tile; continues() must be true. A step from nothing replaces the tile's content.
void take_step(const VotedStep& step, VotedTile& tile);

/// Assembles the pages of VOTED_POINTS. A step is complete when all its pages have come, in any order; pages of an
/// older revision than the one being assembled, and duplicates, are ignored.
class VotedTileAssembler {
 public:
  static constexpr std::int32_t kMaxPoints = 400'000;  ///< of a tile; more is invalid
  static constexpr std::int32_t kMaxPages = 1000;      ///< of a step
  static constexpr std::size_t kMaxUnfinished = 2000;  ///< tiles being assembled; the longest waiting is dropped first

  /// The step that this page completes, if it does. Invalid pages and inconsistent steps are refused and counted.
  [[nodiscard]] std::optional<VotedStep> add(voted_points_t page, Counters& counters);
  void clear() { unfinished_.clear(); }

 private:
  struct Unfinished {
    VotedStep step;  // without pages, until all have come
    std::map<std::int32_t, voted_points_t> pages;
    std::int32_t num_pages = 0;
    std::int64_t turn = 0;
  };
  void drop_oldest(Counters& counters);
  std::map<TileKey, Unfinished> unfinished_;
  std::int64_t turn_ = 0;
};

}  // namespace curbstone::semantic_map::tile
