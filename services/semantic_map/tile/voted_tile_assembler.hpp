#pragma once

#include <curbstone/voted_points_t.hpp>
#include <map>
#include <optional>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::tile {

/// All pages of one step of a tile, as they were sent.
struct VotedStep {
  TileKey key;
  std::int64_t chain = 0;
  std::int32_t base = 0;
  std::int32_t revision = 0;
  std::vector<voted_points_t> pages;
};

/// Whether `tile` is what the step goes on from, or a later part of the same way; nullptr: there is none.
[[nodiscard]] bool goes_on_from(const VotedStep& step, const VotedTile* tile);
/// Takes a tile to the step's revision; goes_on_from() must be true. A step from nothing replaces what the tile is.
void take_step(const VotedStep& step, VotedTile& tile);

/// Puts the pages of VOTED_POINTS together. A step is taken when all its pages are there, in whatever order they come;
/// pages of an older revision than the one in the making, and pages that arrive twice, change nothing.
class VotedTileAssembler {
 public:
  static constexpr std::int32_t kMaxPoints = 400'000;  ///< of a tile; more is no tile
  static constexpr std::int32_t kMaxPages = 1000;      ///< of a step
  static constexpr std::size_t kMaxUnfinished = 2000;  ///< tiles in the making; the one that waits longest goes first

  /// The step that this page completes, if it does. Bad pages, and steps that do not add up, are refused and counted.
  [[nodiscard]] std::optional<VotedStep> add(const voted_points_t& page, Counters& counters);
  void clear() { unfinished_.clear(); }

 private:
  struct Unfinished {
    VotedStep step;  // its pages: when all are there
    std::map<std::int32_t, voted_points_t> pages;
    std::int32_t num_pages = 0;
    std::int64_t turn = 0;
  };
  void drop_oldest(Counters& counters);
  std::map<TileKey, Unfinished> unfinished_;
  std::int64_t turn_ = 0;
};

}  // namespace curbstone::semantic_map::tile
