#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/tensor_voting/cuda/cuda_voting_field.hpp"
#include "services/tensor_voting/voting/voting_field.hpp"
#include "tools/bench/voting/scan_times.hpp"

namespace curbstone::bench::voting {

/// A growing map on a GPU, beside the CPU's: wall time of the calls, with all that goes up and comes down.
struct CudaGrowth {
  ScanTimes add;              ///< a revolution's points into all fields
  ScanTimes votes;            ///< the changed tiles' votes out of them
  std::size_t compared = 0;   ///< voters, at the end
  std::size_t different = 0;  ///< of them, whose sums have other bits than VotingField's
};

/// The fields of CudaVotingField, fed as a worker would: what a revolution brought, at once.
class CudaFields {
 public:
  /// Empty ones, one a scale. All functions throw what they do.
  explicit CudaFields(std::vector<tensor_voting::cuda::CudaVotingField> fields);

  /// Kept until the revolution ends. Of a tile that is `replaced`, `points` are all there are.
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
