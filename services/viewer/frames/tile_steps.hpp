#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/viewer/store/live_map.hpp"

namespace curbstone::viewer::frames {

/// The latest changes of the map, encoded once for all pages that are level: a step holds the tile records that take
/// whoever has everything up to number `from` to number `to`. Bounded by kMaxSteps and kMaxBytes. Pure; one thread.
class TileSteps {
 public:
  static constexpr std::size_t kMaxSteps = 30;
  static constexpr std::size_t kMaxBytes = 400'000;

  struct Step {
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    std::vector<std::uint8_t> records;
  };

  /// To be called before a tile is put into the map: `before` is what the tile was until now, null if it was not there.
  void will_change(TileKey key, const store::TileCells* before);
  /// Makes a step of what changed since the last one. Nothing, if nothing did.
  void close(const store::LiveMap& map);
  /// The map was cleared.
  void clear(const store::LiveMap& map);

  /// The steps that lead from `number` to the last one, in order; nothing if there is no such way.
  [[nodiscard]] std::optional<std::vector<const Step*>> from(std::uint64_t number) const;

 private:
  std::uint64_t number_ = 0;  // up to which steps were made
  std::unordered_map<TileKey, std::optional<store::TileCells>, TileKeyHash> before_;
  std::deque<Step> steps_;
  std::size_t bytes_ = 0;
};

}  // namespace curbstone::viewer::frames
