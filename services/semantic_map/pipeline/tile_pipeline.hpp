#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "common/tiles/lru_order.hpp"
#include "services/semantic_map/cells/cell_classes.hpp"
#include "services/semantic_map/cells/driven_cells.hpp"
#include "services/semantic_map/curbs/curb_evidence.hpp"
#include "services/semantic_map/curbs/curb_filter.hpp"
#include "services/semantic_map/ground/ground_model.hpp"
#include "services/semantic_map/layers/tile_layers.hpp"
#include "services/semantic_map/markings/marking_cells.hpp"
#include "services/semantic_map/pipeline/tile_work.hpp"
#include "services/semantic_map/tile/voted_tile_assembler.hpp"

namespace curbstone::semantic_map::pipeline {

/// From voted points to the semantic map, tile by tile:
///
///   voted points -> ground samples -> [3x3] ground model -> [3x3] curb evidence -> [3x3] curbs ---> [3x3] classes
///                                                       \-> columns -> [3x3] vehicles -> [3x3] -/
///                                          [3x3] ground -> paint -> [3x3] marking cells <- [3x3] curbs, classes
///
/// Each step of a tile is a pure function of earlier steps of the tile and of its eight neighbours (compute()). A step
/// is stale when one of its inputs has changed since it was computed. If its result is equal to the one before, nothing
/// else becomes stale. A tile can be updated early, from the present results of its neighbours. Once everything is
/// settled, the map is a function of the voted points and the driven cells alone: it depends neither on their order nor
/// on the order of work.
///
/// A tile sleeps (layers::SleepingLayers), in a file if there is one, if no step has read it for kAwake (see
/// set_time()). A step wakes the tiles that it reads. A tile that was woken for kOldestStep alone sleeps again after
/// kAwakeForOldStep.
class TilePipeline {
 public:
  TilePipeline(const tile::CurbParameters& curb, const cells::ClassParameters& classes,
               const markings::MarkingParameters& markings = {},
               std::shared_ptr<SpillFile> spill_file = std::make_shared<SpillFile>())
      : curb_(curb), classes_(classes), markings_(markings), spill_file_(std::move(spill_file)) {}

  /// Brings a tile to the revision of the step. Nothing if the step does not continue the tile's revision.
  std::optional<VotedChange> apply(const tile::VotedStep& step);
  /// Replaces a whole tile. `has_grown`: its points begin with those of the earlier one; their tensors may differ.
  void set_voted(tile::VotedTile voted, bool has_grown = false);
  /// The vehicle drove over these cells of a tile, which may not exist yet.
  void add_driven(TileKey key, const cells::CellBits& driven);
  /// Discards everything: another epoch begins.
  void clear();
  /// The time by which tiles fall asleep, us, of any clock. If it is never set, no tile sleeps. To be called as time
  /// passes: while the vehicle stands nothing else puts tiles to sleep.
  void set_time(std::int64_t now) {
    now_ = now;
    let_sleep();
  }

  /// Does one piece of work; none for a tile without voted points.
  WorkResult run(const TileWork& work);
  /// Computes everything that is stale, and returns what changed. `threads`: 0 means one for each core; the result does
  /// not depend on their number.
  WorkResult settle(int threads = 0);
  [[nodiscard]] Backlog backlog() const;

  /// The tile as last computed; nullptr if it has not been computed yet. The object never changes; it is replaced.
  [[nodiscard]] std::shared_ptr<const tile::MapTile> classes(TileKey key) const;
  /// The curb points of a tile as last computed, m from the tile's corner. The object never changes; it is replaced.
  [[nodiscard]] std::shared_ptr<const std::vector<curbs::CurbPoint>> curbs(TileKey key) const;
  /// The cells of paint of a tile as last computed, likewise.
  [[nodiscard]] std::shared_ptr<const std::vector<markings::MarkingCell>> markings(TileKey key) const;
  /// The tiles that are new, or whose classes, curbs or markings were replaced, since the last call; each once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  [[nodiscard]] std::vector<TileKey> keys() const;  ///< sorted
  /// Keys of the tiles that intersect a box, m in map; sorted.
  [[nodiscard]] std::vector<TileKey> keys_in(const Eigen::Vector2d& min, const Eigen::Vector2d& max) const;
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  [[nodiscard]] std::size_t num_asleep() const { return tiles_.size() - uses_.size() - visits_.size(); }
  /// Tiles whose layers could not be read back from the file since the last call: they must be sent again as a whole.
  [[nodiscard]] std::vector<TileKey> take_lost() { return std::exchange(lost_, {}); }
  static constexpr std::int64_t kAwake = 10'000'000;           ///< us
  static constexpr std::int64_t kAwakeForOldStep = 1'500'000;  ///< us
  /// Number of stale steps, of all tiles.
  [[nodiscard]] std::size_t num_stale() const;
  /// How often the curb evidence of a tile has been computed.
  [[nodiscard]] std::int64_t num_evidence() const { return num_evidence_; }

 private:
  enum Step { kSamples, kGround, kEvidence, kColumns, kVehicles, kCurbs, kClasses, kPaint, kMarkings, kNumSteps };
  /// The steps that an update of a tile computes; the others are computed when they are the oldest stale step.
  static constexpr std::array kUrgentSteps = {kSamples, kGround, kEvidence, kColumns, kVehicles, kCurbs, kClasses};
  static constexpr std::array kPatientSteps = {kPaint, kMarkings};
  static constexpr std::int64_t kFresh = 0;
  struct Tile {
    layers::SleepingLayers layers;
    ground::GroundModel ground;
    std::vector<curbs::CurbCandidate> evidence;
    std::vector<cells::VehicleOutline> vehicles;  ///< in cells from the tile's corner
    double update_cost = 0;                       ///< WorkResult::cost of its last update; 0: there was none
    std::int64_t evidence_utime = 0;              ///< us, of the newest points in which evidence was searched
    bool has_new_evidence = true;                 ///< the evidence here or around differs from that of `curbs`
    std::shared_ptr<const std::vector<curbs::CurbPoint>> curbs = std::make_shared<std::vector<curbs::CurbPoint>>();
    std::int64_t curbs_utime = 0;  ///< us, of the evidence
    std::shared_ptr<const tile::MapTile> classes;
    std::shared_ptr<const std::vector<markings::MarkingCell>> markings =
        std::make_shared<std::vector<markings::MarkingCell>>();
    bool is_in_changed = false;
    std::array<std::int64_t, kNumSteps> stale{};  ///< its turn in stale_, or kFresh
  };
  [[nodiscard]] Tile* find(TileKey key);
  /// Must be called before a tile's layers are read or written.
  void wake(TileKey key, Tile& tile);
  void wake_for(Step step, TileKey key, Tile& tile);
  void sleep(TileKey key);
  void let_sleep();
  template <class T, class Get>
  tile::Around<T> around(TileKey key, Get get);
  /// Calls visit(key, tile) for the tile and those of its neighbours that exist.
  template <class Visit>
  void for_around(TileKey key, Visit visit);

  void note_change(TileKey key, Tile& tile);
  void mark(Step step, TileKey key, Tile& tile);
  void mark_around(Step step, TileKey key);
  [[nodiscard]] static std::int64_t first_turn(const std::map<std::int64_t, TileKey>& stale);
  /// Marks a step as fresh. Returns whether it was stale.
  bool unmark(Step step, Tile& tile);
  void voted_changed(TileKey key, Tile& tile, bool is_new, bool has_grown);
  void update(TileKey key);
  void update_columns(TileKey key);
  void settle_oldest();
  void refresh(Step step, TileKey key, Tile& tile);
  /// The result of a step. compute() reads the results of earlier steps, and changes nothing.
  using Product = std::variant<std::monostate, ground::GroundSamples, ground::GroundModel, curbs::CurbEvidence,
                               std::vector<cells::VehicleOutline>, std::vector<curbs::CurbPoint>, tile::MapTile,
                               markings::PaintLayer, std::vector<markings::MarkingCell>>;
  [[nodiscard]] Product compute(Step step, TileKey key, const Tile& tile);
  [[nodiscard]] tile::MapTile classify(TileKey key, const Tile& tile);
  void take(TileKey key, Tile& tile, std::monostate columns);
  void take(TileKey key, Tile& tile, const ground::GroundSamples& samples);
  void take(TileKey key, Tile& tile, const ground::GroundModel& ground);
  void take(TileKey key, Tile& tile, curbs::CurbEvidence evidence);
  void take(TileKey key, Tile& tile, std::vector<cells::VehicleOutline> vehicles);
  void take(TileKey key, Tile& tile, std::vector<curbs::CurbPoint> curbs);
  void take(TileKey key, Tile& tile, const tile::MapTile& classes);
  void take(TileKey key, Tile& tile, markings::PaintLayer paint);
  void take(TileKey key, Tile& tile, std::vector<markings::MarkingCell> markings);
  void take_curbs_utime(TileKey key, Tile& tile);
  void settle_step(Step step, int threads);
  void refresh_columns(TileKey key, Tile& tile);
  void measure_columns(TileKey key, Tile& tile);

  tile::CurbParameters curb_;
  cells::ClassParameters classes_;
  markings::MarkingParameters markings_;
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles_;
  std::unordered_map<TileKey, cells::CellBits, TileKeyHash> driven_;
  std::array<std::map<std::int64_t, TileKey>, kNumSteps> stale_;  ///< by turn, the oldest first
  std::int64_t turn_ = kFresh;
  /// Column statistics of a tile that grows, so that only its new points are added.
  struct GroundedAccumulator {
    cells::ColumnAccumulator accumulator;
    bool ground_moved = false;  ///< the ground has changed since the accumulator was made
  };
  std::unordered_map<TileKey, GroundedAccumulator, TileKeyHash> accumulators_;
  LruOrder uses_;                  ///< of the tiles that are awake, by now_
  LruOrder visits_;                ///< likewise, of tiles that were woken for kOldestStep alone
  bool does_old_step_ = false;     ///< the present work is kOldestStep
  std::int64_t now_ = 0;           ///< us
  std::vector<TileKey> awakened_;  ///< by the present work
  std::vector<TileKey> lost_;
  std::shared_ptr<SpillFile> spill_file_;  ///< layers of sleeping tiles
  WorkResult result_;                      ///< of the present work
  std::vector<TileKey> changed_;           ///< for take_changed()
  std::int64_t num_evidence_ = 0;
};

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

}  // namespace curbstone::semantic_map::pipeline
