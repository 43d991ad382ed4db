#include "services/semantic_map/tile_pipeline.hpp"

#include <algorithm>
#include <limits>

namespace curbstone {

TilePipeline::Tile* TilePipeline::find(TileKey key) {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second;
}

/// update(key, tile): the tiles that exist within `reach` of a key.
template <class Update>
void TilePipeline::for_neighbours(TileKey key, int reach, Update update) {
  constexpr std::int64_t kMin = std::numeric_limits<std::int32_t>::min();
  constexpr std::int64_t kMax = std::numeric_limits<std::int32_t>::max();
  for (std::int64_t y = std::int64_t{key.y} - reach; y <= std::int64_t{key.y} + reach; ++y) {
    for (std::int64_t x = std::int64_t{key.x} - reach; x <= std::int64_t{key.x} + reach; ++x) {
      if (x < kMin || x > kMax || y < kMin || y > kMax) continue;
      const TileKey neighbour{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
      if (Tile* tile = find(neighbour)) update(neighbour, *tile);
    }
  }
}

/// get(key, tile): pointer to the product of one tile, brought up to date.
template <class T, class Get>
Around<T> TilePipeline::around(TileKey key, Get get) {
  Around<T> result;
  for_neighbours(key, 1, [&](TileKey neighbour, Tile& tile) {
    result.set(neighbour.x - key.x, neighbour.y - key.y, get(neighbour, tile));
  });
  return result;
}

void TilePipeline::set_voted(VotedTile voted) {
  const TileKey key = voted.key;
  Tile& tile = tiles_[key];
  tile.voted = std::move(voted);
  tile.samples = sample_ground(tile.voted, curb_);
  for_neighbours(key, 1, [](TileKey, Tile& t) { t.ground_fresh = false; });
  for_neighbours(key, 2, [](TileKey, Tile& t) { t.evidence_fresh = false; });
  for_neighbours(key, 3, [](TileKey, Tile& t) { t.curbs_fresh = false; });
  for_neighbours(key, 4, [this](TileKey k, Tile&) { dirty_.insert(k); });
}

void TilePipeline::clear() {
  tiles_.clear();
  dirty_.clear();
}

void TilePipeline::refresh_ground(TileKey key, Tile& tile) {
  if (tile.ground_fresh) return;
  tile.ground = model_ground(around<GroundSamples>(key, [](TileKey, Tile& t) { return &t.samples; }), curb_);
  tile.ground_fresh = true;
}

void TilePipeline::refresh_evidence(TileKey key, Tile& tile) {
  if (tile.evidence_fresh) return;
  const GroundSurface ground(around<GroundModel>(key, [this](TileKey k, Tile& t) {
    refresh_ground(k, t);
    return &t.ground;
  }));
  tile.evidence = find_curb_evidence(around<VotedTile>(key, [](TileKey, Tile& t) { return &t.voted; }), ground, curb_);
  tile.columns = measure_columns(tile.voted, ground, classes_);
  tile.evidence_fresh = true;
  ++work_;
}

void TilePipeline::refresh_curbs(TileKey key, Tile& tile) {
  if (tile.curbs_fresh) return;
  tile.curbs = filter_curbs(around<std::vector<CurbCandidate>>(key,
                                                               [this](TileKey k, Tile& t) {
                                                                 refresh_evidence(k, t);
                                                                 return &t.evidence;
                                                               }),
                            curb_);
  tile.curbs_fresh = true;
}

std::optional<MapTile> TilePipeline::compute(TileKey key) {
  Tile* tile = find(key);
  dirty_.erase(key);
  if (tile == nullptr) return std::nullopt;
  const auto curbs = around<std::vector<CurbPoint>>(key, [this](TileKey k, Tile& t) {
    refresh_curbs(k, t);
    return &t.curbs;
  });
  const auto columns = around<CellColumns>(key, [this](TileKey k, Tile& t) {
    refresh_evidence(k, t);
    return &t.columns;
  });
  MapTile result;
  result.key = key;
  result.utime = tile->voted.utime;
  result.z_origin = tile->voted.z_origin;
  classify_cells(columns, curbs, classes_, result);
  return result;
}

const std::vector<CurbPoint>* TilePipeline::curbs(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second.curbs;
}

std::vector<TileKey> TilePipeline::keys() const {
  std::vector<TileKey> keys;
  keys.reserve(tiles_.size());
  for (const auto& [key, tile] : tiles_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace curbstone
