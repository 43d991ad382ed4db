#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/tensor_voting/cuda/cuda_voting_field.hpp"
#include "services/tensor_voting/voting/voting_field.hpp"
#include "tools/bench/voting/scan_times.hpp"

namespace curbstone::bench::voting {

/// Voting on a growing map on a GPU, next to the CPU's: wall time of the calls, including transfers in both directions.
struct CudaGrowth {
  ScanTimes add;              ///< adding a revolution's points to all fields
  ScanTimes votes;            ///< reading the changed tiles' votes
  std::size_t compared = 0;   ///< voters, at the end
  std::size_t different = 0;  ///< voters whose sums are not bit-identical to VotingField's
};

/// The fields of CudaVotingField, fed once per revolution with all its points, as a worker does.
class CudaFields {
 public:
  /// `fields`: empty ones, one per scale. All functions throw what theirs throw.
  explicit CudaFields(std::vector<tensor_voting::cuda::CudaVotingField> fields);

  /// Collects points until the revolution ends. If a tile is `replaced`, `points` are its full content.
  void add(TileKey key, std::int32_t z_origin, bool replaced, std::span<const TilePoint> points);
  void end_revolution(bool counts);
  /// `fields`: the CPU's, in the order of the scales, fed with the same points.
  [[nodiscard]] CudaGrowth growth(std::span<const tensor_voting::voting::VotingField> fields,
                                  std::span<const TileKey> keys);

 private:
  struct Waiting {
    TileKey key;
    std::int32_t z_origin;
    std::vector<TilePoint> points;
  };
  std::vector<tensor_voting::cuda::CudaVotingField> fields_;
  std::vector<Waiting> waiting_;
  std::vector<TileKey> replaced_;
  std::vector<double> add_ms_;
  std::vector<double> votes_ms_;
};

}  // namespace curbstone::bench::voting
