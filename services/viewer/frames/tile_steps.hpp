#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/viewer/store/live_map.hpp"

namespace curbstone::viewer::frames {

/// The latest changes of the map, encoded once for all pages that are up to date. A step holds the tile records that
/// take a page from number `from` to number `to`. Bounded by kMaxSteps and kMaxBytes. Pure; one thread.
class TileSteps {
 public:
  static constexpr std::size_t kMaxSteps = 30;
  static constexpr std::size_t kMaxBytes = 400'000;

  struct Step {
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    std::vector<std::uint8_t> records;
  };

  /// Call it before a tile is put into the map. `before`: the tile's present content, null if there is none.
  void will_change(TileKey key, const store::TileCells* before);
  /// Makes a step of all changes since the last one, if there are any.
  void close(const store::LiveMap& map);
  /// Call it after the map was cleared.
  void clear(const store::LiveMap& map);

  /// The steps that lead from `number` to the latest one, in order. Empty if the kept steps do not start at `number`.
  [[nodiscard]] std::optional<std::vector<const Step*>> from(std::uint64_t number) const;

 private:
  std::uint64_t number_ = 0;  // of the map, at the last close()
  std::unordered_map<TileKey, std::optional<store::TileCells>, TileKeyHash> before_;
  std::deque<Step> steps_;
  std::size_t bytes_ = 0;
};

}  // namespace curbstone::viewer::frames
