#include "services/viewer/store/live_map.hpp"

namespace curbstone::viewer::store {

LiveMap::Put LiveMap::put(TileKey key, const TileCells& cells) {
  const auto known = tiles_.find(key);
  if (known == tiles_.end() && tiles_.size() >= kMaxTiles) return Put::kFull;
  if (known != tiles_.end()) {
    if (cells.revision <= known->second.cells.revision) return Put::kKnown;
    by_number_.erase(known->second.number);
  }
  tiles_[key] = {++number_, cells};
  by_number_.emplace_hint(by_number_.end(), number_, key);
  return Put::kTaken;
}

void LiveMap::clear() {
  tiles_.clear();
  by_number_.clear();
}

const TileCells* LiveMap::at(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second.cells;
}

std::vector<LiveMap::Change> LiveMap::above(std::uint64_t number, std::size_t max_tiles) const {
  std::vector<Change> changes;
  for (auto it = by_number_.upper_bound(number); it != by_number_.end() && changes.size() < max_tiles; ++it)
    changes.push_back({it->first, it->second, at(it->second)});
  return changes;
}

}  // namespace curbstone::viewer::store
