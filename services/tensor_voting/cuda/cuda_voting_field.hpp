#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::cuda {

class ResidentVoters;
struct CellGrid;

/// VotingField on a GPU. The voters and their sums stay on the device: only new points are uploaded, only new pairs are
/// computed, and requested tiles are downloaded. Voters, sums and numbers of votes are bitwise equal to VotingField's,
/// whatever the order of arrival. Points go to the device in batches: pass all points of a revolution to add() at once.
///
/// Tiles must lie within 50 km of the first one (at sigma 0.1 m; in proportion to the radius). Takes at most 2 x 84
/// bytes of device memory a voter. One thread at a time. Functions that use the device throw std::runtime_error with
/// CUDA's error text when it fails; the field is then empty.
class CudaVotingField {
 public:
  /// Makes the device's part. Tests replace it by the host.
  using MakeVoters = std::function<std::unique_ptr<ResidentVoters>(const CellGrid&, const kernels::Decay&)>;

  /// Throws std::invalid_argument on parameters that VotingField does not accept, and std::runtime_error if there is no
  /// device (why_no_cuda()).
  explicit CudaVotingField(const voting::VotingParameters& parameters, std::size_t max_voters = 8'000'000);
  CudaVotingField(const voting::VotingParameters& parameters, std::size_t max_voters, const MakeVoters& make_voters);
  ~CudaVotingField();
  CudaVotingField(CudaVotingField&&) noexcept;
  CudaVotingField& operator=(CudaVotingField&&) noexcept;

  struct Addition {
    TileKey key;
    std::int32_t z_origin = 0;  ///< of the tile's z = 0, in steps; fixed by its first points
    std::span<const TilePoint> points;
  };
  /// Appends points to tiles. Throws std::invalid_argument for points outside their tile and tiles too far away, and
  /// std::runtime_error if all points together with the voters would exceed max_voters; the field is then unchanged.
  void add(std::span<const Addition> additions);
  void add(TileKey key, std::int32_t z_origin, std::span<const TilePoint> points);
  /// Removes tiles, and their votes from the tiles around them.
  void remove(std::span<const TileKey> keys);
  void remove(TileKey key);
  void clear();

  [[nodiscard]] bool contains(TileKey key) const { return tiles_.contains(key); }
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  [[nodiscard]] std::size_t num_points(TileKey key) const;
  [[nodiscard]] std::size_t num_voters(TileKey key) const;
  [[nodiscard]] std::size_t num_voters() const { return num_voters_; }
  /// The voter whose tensor each point of a tile takes, in the order of the points.
  [[nodiscard]] std::span<const std::uint32_t> voters_of_points(TileKey key) const;
  /// The tiles whose points or tensors changed since the last call, in order of their keys.
  [[nodiscard]] std::vector<TileKey> take_changed();

  struct TileVotes {
    std::vector<kernels::VoteSums> sums;  ///< of each voter
    std::int64_t num_votes = 0;           ///< received by all of them: a version number of the tile's tensors
  };
  /// The votes of several tiles, in one download. A tile that is not in the field has no voters.
  [[nodiscard]] std::vector<TileVotes> votes(std::span<const TileKey> keys);
  [[nodiscard]] TileVotes votes(TileKey key);

 private:
  struct Tile;
  struct Fresh;

  void check(std::span<const Addition> additions, TileKey origin) const;
  void append(const Addition& addition, Fresh& fresh);
  std::uint32_t take_slot(TileKey key);
  void note_changes(const std::vector<std::uint8_t>& changed);
  /// Calls work(); if that throws, empties the field and rethrows.
  template <class Work>
  auto guarded(const Work& work);

  std::size_t max_voters_;
  int voxel_ = 0;  // steps; 0: no thinning
  std::unique_ptr<CellGrid> grid_;
  std::unique_ptr<ResidentVoters> voters_;
  TileKey origin_;  // cells are counted from its corner
  std::unordered_map<TileKey, std::unique_ptr<Tile>, TileKeyHash> tiles_;
  std::vector<TileKey> key_of_slot_;
  std::vector<std::uint32_t> free_slots_;
  std::size_t num_voters_ = 0;
  std::set<TileKey> changed_;
};

}  // namespace curbstone::tensor_voting::cuda
