#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "services/semantic_map/cell_classes.hpp"
#include "services/semantic_map/curb_evidence.hpp"
#include "services/semantic_map/curb_filter.hpp"
#include "services/semantic_map/ground_model.hpp"

namespace curbstone {

/// From voted points to the semantic map, tile by tile:
///
///   voted points -> ground samples -> [3x3] ground model -> [3x3] curb evidence -> [3x3] curbs ---> [3x3] classes
///                                                       \-> columns --------------------------/
///
/// Each step of a tile is a pure function of the step before of it and its eight neighbours. A step is stale when one
/// of those has become another since it was computed; a result that came out equal makes nothing stale. Whoever is in
/// a hurry updates one tile with what its neighbours have by now. Once everything is settled, the map is a function of
/// the voted points alone: not of the order in which they came, nor of how often somebody looked.
class TilePipeline {
 public:
  TilePipeline(const CurbParameters& curb, const ClassParameters& classes) : curb_(curb), classes_(classes) {}

  /// Takes the newest revision of a tile. `has_grown`: its points are those of the one before and more behind them,
  /// whatever their tensors.
  void set_voted(VotedTile tile, bool has_grown = false);
  /// The newest revision of a tile; nullptr if there is none.
  [[nodiscard]] const VotedTile* voted(TileKey key) const;
  /// Lends it, to be changed and set again at once; an empty one if there is none.
  [[nodiscard]] VotedTile lend_voted(TileKey key);
  /// Another epoch begins.
  void clear();

  /// Brings a tile's own steps up to date, with its neighbours' as they are. Nothing if no voted points are known of
  /// it.
  std::optional<MapTile> update(TileKey key);
  /// The same, but on the ground and with the curbs that it had: what stands where, at a tenth of the cost. Where the
  /// ground has moved since, the columns stay stale.
  std::optional<MapTile> update_columns(TileKey key);
  /// Computes what has been stale for longest, of any tile, if it is since before `turn`. False if nothing is.
  bool settle_one(std::int64_t turn = std::numeric_limits<std::int64_t>::max());
  /// Counts what becomes stale: now's turn.
  [[nodiscard]] std::int64_t turn() const { return turn_; }
  /// Computes all that is stale.
  void settle();
  /// Tiles whose classes have become others since the last call; after update() and settle_one().
  [[nodiscard]] std::set<TileKey> take_changed();

  /// The tile as it was computed last; nullptr if it never was.
  [[nodiscard]] const MapTile* classes(TileKey key) const;
  /// The curb points of a tile as they were computed last; frame: the tile's corner.
  [[nodiscard]] const std::vector<CurbPoint>* curbs(TileKey key) const;
  [[nodiscard]] std::vector<TileKey> keys() const;  ///< sorted
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  /// Steps of tiles that are stale.
  [[nodiscard]] std::size_t num_stale() const;
  /// How often tiles' evidence has been computed.
  [[nodiscard]] std::int64_t num_evidence() const { return num_evidence_; }
  /// What has been computed so far, where the evidence of a tile counts 1: for whoever has a budget.
  [[nodiscard]] double work() const { return work_; }

 private:
  enum Step { kSamples, kGround, kEvidence, kColumns, kCurbs, kClasses, kNumSteps };
  static constexpr std::array kAllSteps = {kSamples, kGround, kEvidence, kColumns, kCurbs, kClasses};
  static constexpr std::int64_t kFresh = 0;
  struct Tile {
    VotedTile voted;
    GroundSamples samples;
    GroundModel ground;
    std::vector<CurbCandidate> evidence;
    std::int64_t evidence_utime = 0;  ///< us, of the newest points that it was looked for in
    CellColumns columns;
    std::vector<CurbPoint> curbs;
    std::int64_t curbs_utime = 0;  ///< us, of the evidence
    std::optional<MapTile> classes;
    std::array<std::int64_t, kNumSteps> stale{};  ///< its turn in stale_, or kFresh
  };
  [[nodiscard]] Tile* find(TileKey key);
  template <class T, class Get>
  Around<T> around(TileKey key, Get get);
  template <class Visit>
  void for_around(TileKey key, Visit visit);

  void mark(Step step, TileKey key, Tile& tile);
  void mark_around(Step step, TileKey key);
  /// False if it was fresh; afterwards it is.
  bool unmark(Step step, Tile& tile);
  void refresh(Step step, TileKey key, Tile& tile);
  void refresh_samples(TileKey key, Tile& tile);
  void refresh_ground(TileKey key, Tile& tile);
  void refresh_evidence(TileKey key, Tile& tile);
  void refresh_columns(TileKey key, Tile& tile);
  void measure_columns(TileKey key, Tile& tile);
  void refresh_curbs(TileKey key, Tile& tile);
  void refresh_classes(TileKey key, Tile& tile);

  CurbParameters curb_;
  ClassParameters classes_;
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles_;
  std::array<std::map<std::int64_t, TileKey>, kNumSteps> stale_;  ///< by turn: the oldest first
  std::int64_t turn_ = kFresh;
  std::set<TileKey> changed_;
  /// Of tiles that grow: so that only their new points need be looked at.
  struct GroundedMeter {
    ColumnMeter meter;
    bool ground_moved = false;  ///< since it was made
  };
  std::unordered_map<TileKey, GroundedMeter, TileKeyHash> meters_;
  double work_ = 0;
  std::int64_t num_evidence_ = 0;
};

}  // namespace curbstone
