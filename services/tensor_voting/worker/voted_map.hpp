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

/// The most by which the number of points and votes of a tile falls with one point: the point, the votes that it has
/// received and those that it has given, in each scale, if every voxel within reach of its own had a voter. (Where
/// every point votes, there may be more than one in 5 cm, and this is an estimate.)
[[nodiscard]] std::int64_t most_votes_lost_with_a_point(std::span<const voting::VotingParameters> scales);

/// The received map points, and the votes on the tiles that matter to this worker. When the set of these tiles changes,
/// new tiles are added piece by piece, nearest first, so that a worker that takes over a large map keeps receiving and
/// publishing. Exact sums make the final result independent of this order.
class VotedMap {
 public:
  VotedMap(PointTiles::Limits limits, std::span<const voting::VotingParameters> scales);

  /// Takes points of a tile; votes on them at once if the tile matters.
  PointTiles::Taken take(const map_points_t& message, bool matters);
  void erase(TileKey key);
  void clear();

  /// Sets the tiles that matter, seen from (x, y), m in map. move() carries the change out.
  void reassign(const std::function<bool(TileKey)>& matters, double x, double y);
  /// Votes on the waiting tiles, nearest first, then removes those that no longer matter, until about `num_points`
  /// points have been moved.
  void move(std::size_t num_points);
  [[nodiscard]] bool is_moving() const { return !moves_.empty(); }

  /// See VotingField.
  void set_time(std::int64_t now);

  [[nodiscard]] const PointTiles& points() const { return points_; }
  [[nodiscard]] std::span<const voting::VotingField> fields() const { return fields_; }
  /// Whether all points of the tile and of its neighbours have voted: its tensors are then those of the known map.
  [[nodiscard]] bool is_current(TileKey key) const;
  /// Whether the tile sleeps in all fields.
  [[nodiscard]] bool is_asleep(TileKey key) const;
  /// The number of the tile's points and of the votes that they have received, plus the most that was lost with each
  /// removed point of the tile and its neighbours; 0 without a tile. It grows with every change, up to 2^31, and
  /// depends on the received records alone.
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
  std::int64_t votes_of_a_point_;            // at most
  std::vector<voting::VotingField> fields_;  // one for each scale, all with the same tiles and points
  std::deque<Move> moves_;
  std::set<TileKey> changed_;
};

/// Calls visit(key) for a tile and its eight neighbours.
template <class Visit>
void for_each_around(TileKey key, Visit visit) {
  for (int i = 0; i < 9; ++i) visit(TileKey{key.x + i % 3 - 1, key.y + i / 3 - 1});
}

}  // namespace curbstone::tensor_voting::worker
