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
///                                                       \-> columns --------------------------/
///                                          [3x3] ground -> paint -> [3x3] marking cells <- [3x3] curbs, classes
///
/// Each step of a tile is a pure function of the steps before it, of the tile and its eight neighbours (compute()). A
/// step is stale when one of its inputs has changed since it was computed; a result that comes out equal makes nothing
/// stale. One tile can be updated early, with what its neighbours have by now. Once everything is settled, the map is a
/// function of the voted points alone: not of the order in which they came, nor of when work was done.
///
/// Tiles that no step has read while kAwake voted steps came sleep (layers::SleepingLayers), in a file if there is one.
/// A step wakes the tiles that it reads; a tile that only an old step has woken sleeps again after kAwakeForOldStep.
class TilePipeline {
 public:
  TilePipeline(const tile::CurbParameters& curb, const cells::ClassParameters& classes,
               const markings::MarkingParameters& markings = {},
               std::shared_ptr<SpillFile> spill_file = std::make_shared<SpillFile>())
      : curb_(curb), classes_(classes), markings_(markings), spill_file_(std::move(spill_file)) {}

  /// Takes a tile to the step's revision. Nothing if the step does not go on from what the tile is.
  std::optional<VotedChange> apply(const tile::VotedStep& step);
  /// Puts a whole tile in place of the one there was. `has_grown`: its points are those of the one before and more
  /// behind them, whatever their tensors.
  void set_voted(tile::VotedTile voted, bool has_grown = false);
  /// Another epoch begins.
  void clear();

  /// Does one piece of work. Nothing is done on a tile of which no voted points are known.
  WorkResult run(const TileWork& work);
  /// Computes all that is stale, and tells what became another. `threads`: 0 for as many as there are cores; the result
  /// is that of one.
  WorkResult settle(int threads = 0);
  [[nodiscard]] Backlog backlog() const;

  /// The tile as it was computed last; nullptr if it never was. It is never changed, only replaced.
  [[nodiscard]] std::shared_ptr<const tile::MapTile> classes(TileKey key) const;
  /// The curb points of a tile as they were computed last; frame: the tile's corner. Never changed, only replaced.
  [[nodiscard]] std::shared_ptr<const std::vector<curbs::CurbPoint>> curbs(TileKey key) const;
  /// The cells of paint of a tile as they were computed last; frame: the tile's corner. Never changed, only replaced.
  [[nodiscard]] std::shared_ptr<const std::vector<markings::MarkingCell>> markings(TileKey key) const;
  /// The tiles that are new, or whose classes, curbs or markings were replaced, since this was asked last; each once.
  [[nodiscard]] std::vector<TileKey> take_changed();
  [[nodiscard]] std::vector<TileKey> keys() const;  ///< sorted
  /// Of the tiles that meet a box, m in map; sorted.
  [[nodiscard]] std::vector<TileKey> keys_in(const Eigen::Vector2d& min, const Eigen::Vector2d& max) const;
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  [[nodiscard]] std::size_t num_asleep() const { return tiles_.size() - uses_.size() - visits_.size(); }
  /// Tiles whose layers the file could not bring back since the last call: they must come again as a whole.
  [[nodiscard]] std::vector<TileKey> take_lost() { return std::exchange(lost_, {}); }
  static constexpr std::int64_t kAwake = 20'000;           ///< voted steps: some ten seconds of a drive
  static constexpr std::int64_t kAwakeForOldStep = 3'000;  ///< voted steps
  /// Steps of tiles that are stale.
  [[nodiscard]] std::size_t num_stale() const;
  /// How often tiles' evidence has been computed.
  [[nodiscard]] std::int64_t num_evidence() const { return num_evidence_; }

 private:
  enum Step { kSamples, kGround, kEvidence, kColumns, kCurbs, kClasses, kPaint, kMarkings, kNumSteps };
  /// Computed for a tile with new points; paint is computed as a stale step.
  static constexpr std::array kUrgentSteps = {kSamples, kGround, kEvidence, kColumns, kCurbs, kClasses};
  static constexpr std::array kPatientSteps = {kPaint, kMarkings};
  static constexpr std::int64_t kFresh = 0;
  struct Tile {
    layers::SleepingLayers layers;
    ground::GroundModel ground;
    std::vector<curbs::CurbCandidate> evidence;
    double update_cost = 0;           ///< of its last update, WorkResult::cost; 0: there was none
    std::int64_t evidence_utime = 0;  ///< us, of the newest points that it was looked for in
    bool is_other_evidence = true;    ///< here or around, than the curbs were made of
    std::shared_ptr<const std::vector<curbs::CurbPoint>> curbs = std::make_shared<std::vector<curbs::CurbPoint>>();
    std::int64_t curbs_utime = 0;  ///< us, of the evidence
    std::shared_ptr<const tile::MapTile> classes;
    std::shared_ptr<const std::vector<markings::MarkingCell>> markings =
        std::make_shared<std::vector<markings::MarkingCell>>();
    bool is_in_changed = false;
    std::array<std::int64_t, kNumSteps> stale{};  ///< its turn in stale_, or kFresh
  };
  [[nodiscard]] Tile* find(TileKey key);
  /// Whoever reads or writes a tile's layers wakes it before.
  void wake(TileKey key, Tile& tile);
  void wake_for(Step step, TileKey key, Tile& tile);
  void sleep(TileKey key);
  void let_sleep();
  template <class T, class Get>
  tile::Around<T> around(TileKey key, Get get);
  template <class Visit>
  void for_around(TileKey key, Visit visit);

  void note_change(TileKey key, Tile& tile);
  void mark(Step step, TileKey key, Tile& tile);
  void mark_around(Step step, TileKey key);
  [[nodiscard]] static std::int64_t first_turn(const std::map<std::int64_t, TileKey>& stale);
  /// False if it was fresh; afterwards it is.
  bool unmark(Step step, Tile& tile);
  void voted_changed(TileKey key, Tile& tile, bool is_new, bool has_grown);
  void update(TileKey key);
  void update_columns(TileKey key);
  void settle_oldest();
  void refresh(Step step, TileKey key, Tile& tile);
  /// The result of a step of a tile: compute() reads what the steps before have made, and changes nothing.
  using Product = std::variant<std::monostate, ground::GroundSamples, ground::GroundModel, curbs::CurbEvidence,
                               std::vector<curbs::CurbPoint>, tile::MapTile, markings::PaintLayer,
                               std::vector<markings::MarkingCell>>;
  /// `vehicles`: of this thread alone; nullptr: nothing is remembered.
  [[nodiscard]] Product compute(Step step, TileKey key, const Tile& tile, cells::VehicleCache* vehicles);
  [[nodiscard]] tile::MapTile classify(TileKey key, const Tile& tile, cells::VehicleCache* vehicles);
  void take(TileKey key, Tile& tile, std::monostate columns);
  void take(TileKey key, Tile& tile, const ground::GroundSamples& samples);
  void take(TileKey key, Tile& tile, const ground::GroundModel& ground);
  void take(TileKey key, Tile& tile, curbs::CurbEvidence evidence);
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
  std::array<std::map<std::int64_t, TileKey>, kNumSteps> stale_;  ///< by turn: the oldest first
  std::int64_t turn_ = kFresh;
  /// Of tiles that grow: so that only their new points need be looked at.
  struct GroundedAccumulator {
    cells::ColumnAccumulator accumulator;
    bool ground_moved = false;  ///< since it was made
  };
  std::unordered_map<TileKey, GroundedAccumulator, TileKeyHash> accumulators_;
  cells::VehicleCache vehicles_;   ///< of the tiles that are computed one by one
  LruOrder uses_;                  ///< of the tiles that are awake, by num_voted_
  LruOrder visits_;                ///< likewise, of those that only old steps have woken
  bool does_old_step_ = false;     ///< the work in hand
  std::int64_t num_voted_ = 0;     ///< voted steps that have come
  std::vector<TileKey> awakened_;  ///< by the work in hand
  std::vector<TileKey> lost_;
  std::shared_ptr<SpillFile> spill_file_;  ///< what sleeps
  WorkResult result_;                      ///< of the work in hand
  std::vector<TileKey> changed_;           ///< for take_changed()
  std::int64_t num_evidence_ = 0;
};

}  // namespace curbstone::semantic_map::pipeline
