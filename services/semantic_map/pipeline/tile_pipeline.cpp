#include "services/semantic_map/pipeline/tile_pipeline.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

namespace curbstone::semantic_map::pipeline {
namespace {

constexpr std::size_t kMaxAccumulators = 512;  // 40 kB each; fewer tiles than this are in sight of the vehicle

/// Cost of a tile's curb evidence, 1 on average. The weights were fitted to the time that it takes in a simulated town.
double cost_of(const curbs::SearchEffort& effort) {
  return 5e-5 * static_cast<double>(effort.points) + 1.1e-3 * static_cast<double>(effort.windows) +
         1e-5 * static_cast<double>(effort.window_points);
}

}  // namespace

std::int64_t TilePipeline::first_turn(const std::map<std::int64_t, TileKey>& stale) {
  return stale.empty() ? std::numeric_limits<std::int64_t>::max() : stale.begin()->first;
}

TilePipeline::Tile* TilePipeline::find(TileKey key) {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second;
}

/// The products of the tile and its neighbours; get(tile) returns a pointer to that of one tile.
template <class T, class Get>
tile::Around<T> TilePipeline::around(TileKey key, Get get) {
  tile::Around<T> result;
  for_around(key,
             [&](TileKey neighbour, Tile& tile) { result.set(neighbour.x - key.x, neighbour.y - key.y, get(tile)); });
  return result;
}

/// Makes a step stale. A step that is stale already keeps its turn.
void TilePipeline::mark(Step step, TileKey key, Tile& tile) {
  if (tile.stale[step] != kFresh || (step >= kPaint && !markings_.enabled)) return;
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

std::optional<VotedChange> TilePipeline::apply(const tile::VotedStep& step) {
  awakened_.clear();
  let_sleep();
  Tile* const known = find(step.key);
  if (known != nullptr) wake(step.key, *known);
  if (!tile::continues(step, known == nullptr ? nullptr : &known->layers->voted)) return std::nullopt;
  Tile& tile = known == nullptr ? tiles_[step.key] : *known;
  tile::VotedTile& voted = tile.layers->voted;
  const std::size_t points_before = voted.points.size();
  tile::take_step(step, voted);
  voted_changed(step.key, tile, known == nullptr, step.base > 0);
  return VotedChange{step.key, voted.revision, voted.utime, points_before, voted.points.size(), tile.update_cost};
}

void TilePipeline::set_voted(tile::VotedTile voted, bool has_grown) {
  const TileKey key = voted.key;
  const auto [it, is_new] = tiles_.try_emplace(key);
  wake(key, it->second);
  it->second.layers->voted = std::move(voted);
  voted_changed(key, it->second, is_new, has_grown);
}

void TilePipeline::voted_changed(TileKey key, Tile& tile, bool is_new, bool has_grown) {
  uses_.used(key, now_);
  if (!has_grown) accumulators_.erase(key);
  if (is_new) {
    note_change(key, tile);
    for (const Step step : kUrgentSteps) mark(step, key, tile);
  }
  mark(kSamples, key, tile);
  mark_around(kEvidence, key);
  mark(kColumns, key, tile);
  mark(kClasses, key, tile);  // for the time of its newest point
  mark(kPaint, key, tile);
}

void TilePipeline::add_driven(TileKey key, const cells::CellBits& driven) {
  cells::CellBits& known = driven_[key];
  const cells::CellBits added = driven & ~known;
  if (added.none()) return;
  known |= added;
  Tile* const tile = find(key);
  if (tile == nullptr || !tile->classes) return;
  for (std::size_t i = added._Find_first(); i < added.size(); i = added._Find_next(i)) {
    if (tile->classes->cell_class[i] == tile::CellClass::kUnknown) return mark(kClasses, key, *tile);
  }
}

void TilePipeline::clear() {
  tiles_.clear();
  driven_.clear();
  changed_.clear();
  lost_.clear();
  uses_.clear();
  visits_.clear();
  accumulators_.clear();
  for (auto& step : stale_) step.clear();
}

void TilePipeline::refresh(Step step, TileKey key, Tile& tile) {
  // Costs in units of the evidence of an average tile, as measured in a town. That of the evidence itself is counted
  // (cost_of()), and that of the curbs depends on the number of candidates.
  constexpr std::array kCost = {0.1, 0.2, 0.0, 0.1, 0.01, 0.01, 0.05, 0.1, 0.1};
  constexpr double kCandidateCost = 0.0035;
  if (!unmark(step, tile)) return;
  wake_for(step, key, tile);
  if (step == kCurbs && !tile.has_new_evidence) return take_curbs_utime(key, tile);  // the curbs stay
  result_.cost += kCost[step];
  if (step == kCurbs && !tile.evidence.empty())
    for_around(key, [&](TileKey, Tile& t) { result_.cost += kCandidateCost * static_cast<double>(t.evidence.size()); });
  num_evidence_ += step == kEvidence ? 1 : 0;
  std::visit([&](auto&& product) { take(key, tile, std::forward<decltype(product)>(product)); },
             compute(step, key, tile));
}

TilePipeline::Product TilePipeline::compute(Step step, TileKey key, const Tile& tile) {
  const auto models = [&] { return around<ground::GroundModel>(key, [](Tile& t) { return &t.ground; }); };
  switch (step) {
    case kSamples:
      return ground::sample_ground(tile.layers->voted, curb_);
    case kGround:
      return ground::model_ground(around<ground::GroundSamples>(key, [](Tile& t) { return &t.layers->samples; }));
    case kEvidence:
      return curbs::find_curb_evidence(around<tile::VotedTile>(key, [](Tile& t) { return &t.layers->voted; }),
                                       ground::GroundSurface(models()), curb_);
    case kVehicles:
      return cells::find_vehicles(around<cells::CellColumns>(key, [](Tile& t) { return &t.layers->columns; }));
    case kCurbs:
      return curbs::filter_curbs(around<std::vector<curbs::CurbCandidate>>(key, [](Tile& t) { return &t.evidence; }),
                                 curb_);
    case kClasses:
      return classify(key, tile);
    case kPaint:
      return markings::accumulate_paint(tile.layers->voted, ground::GroundSurface(models()));
    case kMarkings:
      return markings::find_marking_cells(
          {around<markings::PaintLayer>(key, [](Tile& t) { return &t.layers->paint; }),
           around<std::vector<curbs::CurbPoint>>(key, [](Tile& t) { return t.curbs.get(); }), tile.classes.get()},
          markings_);
    case kColumns:  // refresh_columns() adds the new points to the earlier result
    case kNumSteps:
      break;
  }
  return std::monostate{};
}

tile::MapTile TilePipeline::classify(TileKey key, const Tile& tile) {
  tile::MapTile result;
  result.key = key;
  result.utime = tile.layers->voted.utime;
  result.curbs_utime = tile.curbs_utime;
  result.z_origin = tile.layers->voted.z_origin;
  const auto columns = around<cells::CellColumns>(key, [](Tile& t) { return &t.layers->columns; });
  const cells::VehicleCells vehicles =
      cells::cover_vehicles(around<std::vector<cells::VehicleOutline>>(key, [](Tile& t) { return &t.vehicles; }));
  cells::classify_cells(columns, around<std::vector<curbs::CurbPoint>>(key, [](Tile& t) { return t.curbs.get(); }),
                        vehicles, classes_, result);
  if (const auto driven = driven_.find(key); driven != driven_.end()) {
    const ground::GroundSurface ground(around<ground::GroundModel>(key, [](Tile& t) { return &t.ground; }));
    cells::add_driven_road(*columns.centre(), driven->second, vehicles, ground, result);
  }
  return result;
}

void TilePipeline::take(TileKey key, Tile& tile, std::monostate /*columns*/) {
  refresh_columns(key, tile);
}

void TilePipeline::take(TileKey key, Tile& tile, const ground::GroundSamples& samples) {
  if (samples == tile.layers->samples) return;
  tile.layers->samples = samples;
  mark_around(kGround, key);
}

void TilePipeline::take(TileKey key, Tile& tile, const ground::GroundModel& ground) {
  if (ground::is_same_surface(ground, tile.ground)) return;
  tile.ground = ground;
  mark_around(kEvidence, key);
  mark_around(kColumns, key);
  mark_around(kPaint, key);
  for_around(key, [&](TileKey k, Tile& t) {
    if (driven_.contains(k)) mark(kClasses, k, t);
    if (const auto found = accumulators_.find(k); found != accumulators_.end()) found->second.ground_moved = true;
  });
}

void TilePipeline::take(TileKey key, Tile& tile, curbs::CurbEvidence evidence) {
  result_.cost += cost_of(evidence.effort);
  if (std::exchange(tile.evidence_utime, tile.layers->voted.utime) != tile.layers->voted.utime) mark(kCurbs, key, tile);
  if (evidence.candidates == tile.evidence) return;
  tile.evidence = std::move(evidence.candidates);
  mark_around(kCurbs, key);
  for_around(key, [](TileKey, Tile& t) { t.has_new_evidence = true; });
}

void TilePipeline::refresh_columns(TileKey key, Tile& tile) {
  if (const auto it = accumulators_.find(key); it != accumulators_.end() && it->second.ground_moved)
    accumulators_.erase(it);
  measure_columns(key, tile);
}

/// Adds the points that are not in the tile's columns yet, by the ground that the earlier points were measured on.
void TilePipeline::measure_columns(TileKey key, Tile& tile) {
  auto at = accumulators_.find(key);
  if (at == accumulators_.end()) {
    if (accumulators_.size() >= kMaxAccumulators) accumulators_.clear();
    const ground::GroundSurface ground(around<ground::GroundModel>(key, [](Tile& t) { return &t.ground; }));
    at = accumulators_.try_emplace(key, GroundedAccumulator{cells::ColumnAccumulator(ground, classes_)}).first;
  }
  cells::ColumnAccumulator& accumulator = at->second.accumulator;
  accumulator.add(tile.layers->voted.points.places().subspan(accumulator.num_points()));
  cells::CellColumns& columns = tile.layers->columns;
  const auto stood = std::pair(columns.blocked, columns.high);
  if (!accumulator.read(columns)) return;
  mark_around(kClasses, key);
  if (stood != std::pair(columns.blocked, columns.high)) mark_around(kVehicles, key);
}

void TilePipeline::take(TileKey key, Tile& tile, std::vector<cells::VehicleOutline> vehicles) {
  if (vehicles == tile.vehicles) return;
  tile.vehicles = std::move(vehicles);
  mark_around(kClasses, key);
}

void TilePipeline::take(TileKey key, Tile& tile, std::vector<curbs::CurbPoint> curbs) {
  tile.has_new_evidence = false;
  take_curbs_utime(key, tile);
  if (curbs == *tile.curbs) return;
  tile.curbs = std::make_shared<const std::vector<curbs::CurbPoint>>(std::move(curbs));
  note_change(key, tile);
  mark_around(kClasses, key);
  mark_around(kMarkings, key);
}

void TilePipeline::take_curbs_utime(TileKey key, Tile& tile) {
  if (std::exchange(tile.curbs_utime, tile.evidence_utime) != tile.evidence_utime) mark(kClasses, key, tile);
}

void TilePipeline::take(TileKey key, Tile& tile, const tile::MapTile& classes) {
  if (tile.classes && *tile.classes == classes) return;
  if (!tile.classes || tile.classes->cell_class != classes.cell_class) mark(kMarkings, key, tile);
  tile.classes = std::make_shared<const tile::MapTile>(classes);
  note_change(key, tile);
  result_.changed.insert(key);
}

void TilePipeline::take(TileKey key, Tile& tile, markings::PaintLayer paint) {
  if (paint == tile.layers->paint) return;
  tile.layers->paint = std::move(paint);
  mark_around(kMarkings, key);
}

void TilePipeline::take(TileKey key, Tile& tile, std::vector<markings::MarkingCell> markings) {
  if (markings == *tile.markings) return;
  tile.markings = std::make_shared<const std::vector<markings::MarkingCell>>(std::move(markings));
  note_change(key, tile);
  result_.markings = true;
}

void TilePipeline::update(TileKey key) {
  Tile* const tile = find(key);
  if (tile == nullptr) return;
  for (const Step step : kUrgentSteps) refresh(step, key, *tile);
  tile->update_cost = result_.cost;
}

void TilePipeline::update_columns(TileKey key) {
  Tile* const tile = find(key);
  if (tile == nullptr) return;
  wake(key, *tile);
  if (!tile->classes) {
    for (const Step step : {kSamples, kGround}) refresh(step, key, *tile);
  }
  const auto found = accumulators_.find(key);
  if (found != accumulators_.end() && found->second.ground_moved) {
    measure_columns(key, *tile);
  } else {
    refresh(kColumns, key, *tile);
  }
  refresh(kVehicles, key, *tile);
  refresh(kClasses, key, *tile);
}

/// Computes the step that has been stale for longest.
void TilePipeline::settle_oldest() {
  auto* const oldest = std::min_element(stale_.begin(), stale_.end(),
                                        [](const auto& a, const auto& b) { return first_turn(a) < first_turn(b); });
  if (oldest->empty()) return;
  const TileKey key = oldest->begin()->second;
  refresh(static_cast<Step>(oldest - stale_.begin()), key, *find(key));
}

WorkResult TilePipeline::run(const TileWork& work) {
  result_ = {};
  awakened_.clear();
  let_sleep();
  switch (work.kind) {
    case TileWork::Kind::kUpdate:
      update(work.key);
      break;
    case TileWork::Kind::kUpdateColumns:
      update_columns(work.key);
      break;
    case TileWork::Kind::kOldestStep:
      does_old_step_ = true;
      settle_oldest();
      does_old_step_ = false;
      break;
  }
  return std::exchange(result_, {});
}

}  // namespace curbstone::semantic_map::pipeline
