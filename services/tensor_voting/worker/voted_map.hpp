#pragma once

#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <deque>
#include <functional>
#include <set>
#include <span>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/tensor_voting/voting/voting_field.hpp"
#include "services/tensor_voting/worker/point_tiles.hpp"

namespace curbstone::tensor_voting::worker {

/// The map points that have arrived, and the votes on those that matter to this worker. When it becomes another set of
/// tiles that matter, they are brought in piece by piece, the nearest first, so that a worker that takes over a large
/// map never stops to listen and to speak. Exact sums make the order of all this invisible in the end.
class VotedMap {
 public:
  VotedMap(PointTiles::Limits limits, std::span<const voting::VotingParameters> scales);

  /// Takes points of a tile; votes on them at once if they matter.
  PointTiles::Taken take(const map_points_t& message, bool matters);
  void erase(TileKey key);
  void clear();

  /// From now on other tiles matter, seen from (x, y), m in map. move() brings it about.
  void reassign(const std::function<bool(TileKey)>& matters, double x, double y);
  /// Votes on the tiles that wait for it, nearest first, then takes out those that matter no more, until about
  /// `num_points` points have been moved.
  void move(std::size_t num_points);
  [[nodiscard]] bool is_moving() const { return !moves_.empty(); }

  [[nodiscard]] const PointTiles& points() const { return points_; }
  [[nodiscard]] std::span<const voting::VotingField> fields() const { return fields_; }
  /// All points of the tile and of those around it have voted: what its tensors say is what the map says.
  [[nodiscard]] bool is_current(TileKey key) const;
  /// The tile sleeps in all fields.
  [[nodiscard]] bool is_asleep(TileKey key) const;
  /// The number of the tile's points and of the votes that they have received, and enough for each point about that has
  /// been taken out; 0 without a tile. Grows with every change and depends on nothing but the records that have come.
  [[nodiscard]] std::int32_t revision(TileKey key) const;
  /// Tiles whose revision or is_current() may have changed since the last call, in order of their keys.
  [[nodiscard]] std::vector<TileKey> take_changed();
  [[nodiscard]] std::int64_t num_pairs() const;

 private:
  struct Move {
    TileKey key;
    bool in;
  };
  [[nodiscard]] std::size_t num_voted(TileKey key) const { return fields_.front().num_points(key); }
  std::size_t bring_in(TileKey key);
  std::size_t take_out(TileKey key);

  PointTiles points_;
  std::vector<voting::VotingField> fields_;  // one a scale, of the same tiles and points
  std::deque<Move> moves_;
  std::set<TileKey> changed_;
};

/// visit(key) of a tile and the eight around it.
template <class Visit>
void for_each_around(TileKey key, Visit visit) {
  for (int i = 0; i < 9; ++i) visit(TileKey{key.x + i % 3 - 1, key.y + i / 3 - 1});
}

}  // namespace curbstone::tensor_voting::worker
