#include "services/semantic_map/tile_pipeline.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

namespace curbstone {
namespace {

constexpr std::size_t kMostMeters = 512;  // 40 kB each; tiles in sight of the vehicle are fewer

}  // namespace

TilePipeline::Tile* TilePipeline::find(TileKey key) {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second;
}

/// visit(key, tile): the tile and its neighbours, as far as they exist.
template <class Visit>
void TilePipeline::for_around(TileKey key, Visit visit) {
  constexpr std::int64_t kMin = std::numeric_limits<std::int32_t>::min();
  constexpr std::int64_t kMax = std::numeric_limits<std::int32_t>::max();
  for (std::int64_t y = std::int64_t{key.y} - 1; y <= std::int64_t{key.y} + 1; ++y) {
    for (std::int64_t x = std::int64_t{key.x} - 1; x <= std::int64_t{key.x} + 1; ++x) {
      if (x < kMin || x > kMax || y < kMin || y > kMax) continue;
      const TileKey neighbour{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
      if (Tile* tile = find(neighbour)) visit(neighbour, *tile);
    }
  }
}

/// get(tile): pointer to the product of one tile.
template <class T, class Get>
Around<T> TilePipeline::around(TileKey key, Get get) {
  Around<T> result;
  for_around(key,
             [&](TileKey neighbour, Tile& tile) { result.set(neighbour.x - key.x, neighbour.y - key.y, get(tile)); });
  return result;
}

/// What is stale already keeps its turn.
void TilePipeline::mark(Step step, TileKey key, Tile& tile) {
  if (tile.stale[step] != kFresh) return;
  tile.stale[step] = ++turn_;
  stale_[step].emplace(turn_, key);
}

void TilePipeline::mark_around(Step step, TileKey key) {
  for_around(key, [&](TileKey k, Tile& tile) { mark(step, k, tile); });
}

bool TilePipeline::unmark(Step step, Tile& tile) {
  if (tile.stale[step] == kFresh) return false;
  stale_[step].erase(std::exchange(tile.stale[step], kFresh));
  return true;
}

void TilePipeline::set_voted(VotedTile voted, bool has_grown) {
  const TileKey key = voted.key;
  if (!has_grown) meters_.erase(key);
  const auto [it, is_new] = tiles_.try_emplace(key);
  Tile& tile = it->second;
  tile.voted = std::move(voted);
  if (is_new) {
    for (const Step step : kAllSteps) mark(step, key, tile);
  }
  mark(kSamples, key, tile);
  mark_around(kEvidence, key);
  mark(kColumns, key, tile);
  mark(kClasses, key, tile);  // its time is new
}

const VotedTile* TilePipeline::voted(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second.voted;
}

VotedTile TilePipeline::lend_voted(TileKey key) {
  Tile* const tile = find(key);
  return tile == nullptr ? VotedTile{} : std::move(tile->voted);
}

void TilePipeline::clear() {
  tiles_.clear();
  meters_.clear();
  for (auto& step : stale_) step.clear();
  changed_.clear();
}

void TilePipeline::refresh(Step step, TileKey key, Tile& tile) {
  constexpr std::array kWork = {0.05, 0.2, 1.0, 0.05, 0.05, 0.05};  // as they were measured
  if (!unmark(step, tile)) return;
  work_ += kWork[step];
  num_evidence_ += step == kEvidence ? 1 : 0;
  switch (step) {
    case kSamples:
      return refresh_samples(key, tile);
    case kGround:
      return refresh_ground(key, tile);
    case kEvidence:
      return refresh_evidence(key, tile);
    case kColumns:
      return refresh_columns(key, tile);
    case kCurbs:
      return refresh_curbs(key, tile);
    case kClasses:
    case kNumSteps:
      return refresh_classes(key, tile);
  }
}

void TilePipeline::refresh_samples(TileKey key, Tile& tile) {
  const GroundSamples samples = sample_ground(tile.voted, curb_);
  if (samples == tile.samples) return;
  tile.samples = samples;
  mark_around(kGround, key);
}

void TilePipeline::refresh_ground(TileKey key, Tile& tile) {
  GroundModel ground = model_ground(around<GroundSamples>(key, [](Tile& t) { return &t.samples; }), curb_);
  if (is_same_surface(ground, tile.ground)) return;
  tile.ground = ground;
  mark_around(kEvidence, key);
  mark_around(kColumns, key);
  for_around(key, [&](TileKey k, Tile&) {
    if (const auto meter = meters_.find(k); meter != meters_.end()) meter->second.ground_moved = true;
  });
}

void TilePipeline::refresh_evidence(TileKey key, Tile& tile) {
  const GroundSurface ground(around<GroundModel>(key, [](Tile& t) { return &t.ground; }));
  auto evidence = find_curb_evidence(around<VotedTile>(key, [](Tile& t) { return &t.voted; }), ground, curb_);
  if (std::exchange(tile.evidence_utime, tile.voted.utime) != tile.voted.utime) mark(kCurbs, key, tile);
  if (evidence == tile.evidence) return;
  tile.evidence = std::move(evidence);
  mark_around(kCurbs, key);
}

void TilePipeline::refresh_columns(TileKey key, Tile& tile) {
  if (const auto meter = meters_.find(key); meter != meters_.end() && meter->second.ground_moved) meters_.erase(meter);
  measure_columns(key, tile);
}

/// On the ground that the tile was measured on before, if it was.
void TilePipeline::measure_columns(TileKey key, Tile& tile) {
  auto at = meters_.find(key);
  if (at == meters_.end()) {
    if (meters_.size() >= kMostMeters) meters_.clear();
    const GroundSurface ground(around<GroundModel>(key, [](Tile& t) { return &t.ground; }));
    at = meters_.try_emplace(key, GroundedMeter{ColumnMeter(ground, classes_)}).first;
  }
  ColumnMeter& meter = at->second.meter;
  meter.add(std::span(tile.voted.points).subspan(meter.num_points()));
  if (meter.read(tile.columns)) mark_around(kClasses, key);
}

void TilePipeline::refresh_curbs(TileKey key, Tile& tile) {
  auto curbs = filter_curbs(around<std::vector<CurbCandidate>>(key, [](Tile& t) { return &t.evidence; }), curb_);
  if (std::exchange(tile.curbs_utime, tile.evidence_utime) != tile.evidence_utime) mark(kClasses, key, tile);
  if (curbs == tile.curbs) return;
  tile.curbs = std::move(curbs);
  mark_around(kClasses, key);
}

void TilePipeline::refresh_classes(TileKey key, Tile& tile) {
  MapTile result;
  result.key = key;
  result.utime = tile.voted.utime;
  result.curbs_utime = tile.curbs_utime;
  result.z_origin = tile.voted.z_origin;
  classify_cells(around<CellColumns>(key, [](Tile& t) { return &t.columns; }),
                 around<std::vector<CurbPoint>>(key, [](Tile& t) { return &t.curbs; }), classes_, result);
  if (tile.classes == result) return;
  tile.classes = result;
  changed_.insert(key);
}

std::optional<MapTile> TilePipeline::update(TileKey key) {
  Tile* const tile = find(key);
  if (tile == nullptr) return std::nullopt;
  for (const Step step : kAllSteps) refresh(step, key, *tile);
  return tile->classes;
}

std::optional<MapTile> TilePipeline::update_columns(TileKey key) {
  Tile* const tile = find(key);
  if (tile == nullptr) return std::nullopt;
  if (!tile->classes) {
    for (const Step step : {kSamples, kGround}) refresh(step, key, *tile);
  }
  const auto meter = meters_.find(key);
  if (meter != meters_.end() && meter->second.ground_moved) {
    measure_columns(key, *tile);
  } else {
    refresh(kColumns, key, *tile);
  }
  refresh(kClasses, key, *tile);
  return tile->classes;
}

/// In doubt the earlier step: what follows from it would only have to be computed again.
bool TilePipeline::settle_one(std::int64_t before) {
  const auto first_turn = [](const std::map<std::int64_t, TileKey>& stale) {
    return stale.empty() ? std::numeric_limits<std::int64_t>::max() : stale.begin()->first;
  };
  const auto oldest = std::min_element(stale_.begin(), stale_.end(),
                                       [&](const auto& a, const auto& b) { return first_turn(a) < first_turn(b); });
  if (first_turn(*oldest) >= before) return false;
  const TileKey key = oldest->begin()->second;
  refresh(static_cast<Step>(oldest - stale_.begin()), key, *find(key));
  return true;
}

/// Step by step: whatever a step makes stale is of a later one.
void TilePipeline::settle() {
  for (const Step step : kAllSteps) {
    while (!stale_[step].empty()) {
      const TileKey key = stale_[step].begin()->second;
      refresh(step, key, *find(key));
    }
  }
}

std::set<TileKey> TilePipeline::take_changed() {
  return std::exchange(changed_, {});
}

const MapTile* TilePipeline::classes(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() || !it->second.classes ? nullptr : &*it->second.classes;
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

std::size_t TilePipeline::num_stale() const {
  std::size_t count = 0;
  for (const auto& step : stale_) count += step.size();
  return count;
}

}  // namespace curbstone
