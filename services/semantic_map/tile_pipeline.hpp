#pragma once

#include <cstdint>
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
///   voted points -> ground samples -> [3x3] ground model -> [3x3] curb evidence, columns -> [3x3] curbs -> [3x3]
///   classes
///
/// Each step of a tile is a pure function of the step before of it and its eight neighbours; what is out of date is
/// computed again when it is asked for. So the map depends on the voted points alone, not on the order in which they
/// came, nor on how often somebody looked.
class TilePipeline {
 public:
  TilePipeline(const CurbParameters& curb, const ClassParameters& classes) : curb_(curb), classes_(classes) {}

  /// Takes the newest revision of a tile. Marks what depends on it as out of date.
  void set_voted(VotedTile tile);
  /// Another epoch begins.
  void clear();

  /// Tiles whose classes are out of date, by key.
  [[nodiscard]] const std::set<TileKey>& dirty() const { return dirty_; }
  /// The tile up to date; nothing if no voted points are known of it.
  [[nodiscard]] std::optional<MapTile> compute(TileKey key);

  /// The curb points of a tile, as compute() of it or a neighbour last saw them; frame: the tile's corner.
  [[nodiscard]] const std::vector<CurbPoint>* curbs(TileKey key) const;
  [[nodiscard]] std::vector<TileKey> keys() const;  ///< sorted
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  /// Grows by one with every tile whose evidence was computed: what costs, for whoever has a budget.
  [[nodiscard]] std::int64_t work() const { return work_; }

 private:
  struct Tile {
    VotedTile voted;
    GroundSamples samples;
    GroundModel ground;
    std::vector<CurbCandidate> evidence;
    CellColumns columns;
    std::vector<CurbPoint> curbs;
    bool ground_fresh = false;
    bool evidence_fresh = false;
    bool curbs_fresh = false;
  };
  Tile* find(TileKey key);
  template <class T, class Get>
  Around<T> around(TileKey key, Get get);
  template <class Update>
  void for_neighbours(TileKey key, int reach, Update update);

  void refresh_ground(TileKey key, Tile& tile);
  void refresh_evidence(TileKey key, Tile& tile);
  void refresh_curbs(TileKey key, Tile& tile);

  CurbParameters curb_;
  ClassParameters classes_;
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles_;
  std::set<TileKey> dirty_;
  std::int64_t work_ = 0;
};

}  // namespace curbstone
