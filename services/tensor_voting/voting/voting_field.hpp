#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/tiles/lru_order.hpp"
#include "common/tiles/tile.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"
#include "services/tensor_voting/voting/field_grid.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::voting {

struct VoterTile;

/// The votes received by up to kLanes voters of a tile, side by side.
struct ReceivedBlock {
  std::uint32_t number = 0;               ///< among the tile's blocks; constant while the tile is in the field
  std::span<const std::uint32_t> voters;  ///< indices of the tile's voters
  std::array<std::array<std::int64_t, kernels::kLanes>, kernels::VoteSums::kCount> sums;  ///< component after component

  [[nodiscard]] kernels::VoteSums of(std::size_t lane) const {
    kernels::VoteSums result;
    for (std::size_t c = 0; c < sums.size(); ++c) result.value[c] = sums[c][lane];
    return result;
  }
};

/// The ball votes of a growing map of tiles, always exactly up to date. A new point costs only its own pairs, and every
/// pair is computed once for both its ends. After any sequence of add() and remove(), every sum is bitwise equal to
/// that of a field to which the present points were added at once, whatever the order between tiles. vote_cloud() of
/// these points gives the same result to 1e-5.
///
/// The voters are chosen inside each tile by the order of its own points: the first point in a voxel votes. The other
/// points of the voxel take the tensor of that voter.
///
/// A tile sleeps, which saves memory, if no points were added to it or its neighbours for kAwake (see set_time());
/// added points wake it. One thread at a time, including readers.
class VotingField {
 public:
  /// Throws std::invalid_argument on the same conditions as FieldGrid.
  explicit VotingField(const VotingParameters& parameters);
  ~VotingField();
  VotingField(VotingField&&) noexcept;
  VotingField& operator=(VotingField&&) noexcept;

  [[nodiscard]] const VotingParameters& parameters() const { return parameters_; }

  /// Appends points to a tile. `z_origin` is the height of its z = 0 in steps of kPositionStep; the tile's first points
  /// fix it. x and y of points must lie in 0 .. kStepsPerTile - 1.
  void add(TileKey key, std::int32_t z_origin, std::span<const TilePoint> points);
  /// Removes a tile, and its votes from the tiles around it.
  void remove(TileKey key);
  void clear();

  [[nodiscard]] bool contains(TileKey key) const { return tiles_.contains(key); }
  [[nodiscard]] std::size_t num_points(TileKey key) const;
  [[nodiscard]] std::size_t num_voters(TileKey key) const;
  /// The number of votes received by all voters of a tile: a version number of the tile's tensors. It grows whenever
  /// add() changes a tensor of the tile, and depends on the present points alone.
  [[nodiscard]] std::int64_t num_votes(TileKey key) const;
  /// The voter whose tensor each point of a tile takes, in the order of the points.
  [[nodiscard]] std::span<const std::uint32_t> voters_of_points(TileKey key) const;
  /// The point of each voter of a tile, in the order of the voters.
  [[nodiscard]] std::span<const std::uint32_t> points_of_voters(TileKey key) const;
  /// The votes that each voter of a tile has received.
  [[nodiscard]] std::vector<kernels::VoteSums> sums(TileKey key) const;
  /// Visits the voters of a tile whose sums may have changed after change() was `since`: all that changed, and some
  /// others in the same blocks. With `since` 0, all voters.
  void for_each_changed(TileKey key, std::int64_t since, const std::function<void(const ReceivedBlock&)>& visit) const;
  /// The number of calls of add() and remove().
  [[nodiscard]] std::int64_t change() const { return change_; }

  /// The tiles whose points or tensors changed since the last call, in order of their keys.
  [[nodiscard]] std::vector<TileKey> take_changed();

  /// The time by which tiles fall asleep, us, of any clock. If it is never set, no tile sleeps. To be called as time
  /// passes: while the vehicle stands nothing else puts tiles to sleep.
  void set_time(std::int64_t now) {
    now_ = now;
    sleep_unused();
  }
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  [[nodiscard]] bool is_asleep(TileKey key) const;
  [[nodiscard]] std::size_t num_asleep() const { return tiles_.size() - uses_.size(); }
  static constexpr std::int64_t kAwake = 10'000'000;  ///< us
  /// The number of pair votes computed so far, without pairs out of reach.
  [[nodiscard]] std::int64_t num_pairs() const { return num_pairs_; }

 private:
  struct Neighbourhood;
  struct NewVoter;

  [[nodiscard]] Neighbourhood around(TileKey key) const;
  void wake(TileKey key, VoterTile& tile) const;
  void sleep_unused();
  /// The points of `points` that are the first in their voxel; all points are entered in the tile's lists.
  std::vector<NewVoter> admit(TileKey key, VoterTile& tile, std::span<const TilePoint> points) const;
  /// Fills near_ with the blocks of voters in the cells within reach of a cell of the centre tile.
  void find_near(const Neighbourhood& around, const FieldCell& cell, bool with_own_tile);
  /// Exchanges votes between the voter and all voters in near_ within its reach. Returns the number of votes.
  std::int64_t exchange(const kernels::StepPoint& at, float sign, kernels::VoteSums& sums);
  /// Records the votes given to the blocks in near_ since find_near().
  void apply_votes(Neighbourhood& around, std::int64_t sign);
  void note_changes(const Neighbourhood& around);

  /// The tile, asleep or not; nullptr if it is not in the field.
  [[nodiscard]] VoterTile* find(TileKey key) const;

  VotingParameters parameters_;
  FieldGrid grid_;
  kernels::VoteKernel kernel_;
  kernels::Decay decay_;
  std::unordered_map<TileKey, std::unique_ptr<VoterTile>, TileKeyHash> tiles_;
  mutable LruOrder uses_;  // of the tiles that are awake, by now_
  std::set<TileKey> changed_;
  std::int64_t num_pairs_ = 0;
  std::int64_t change_ = 0;
  std::int64_t now_ = 0;  // us
  std::vector<kernels::NearBlock> near_;
  struct Place {
    std::uint32_t tile;  // among the neighbours
    std::uint32_t block;
  };
  std::vector<Place> near_places_;  // of each
};

}  // namespace curbstone::tensor_voting::voting
