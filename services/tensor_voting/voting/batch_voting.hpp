#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "services/tensor_voting/kernels/decomposition.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::voting {

/// @file
/// Voting on a whole cloud at once.

/// Options beyond one pass of ball votes.
struct BatchOptions {
  /// The tensors, now oriented, vote once more: stick and plate votes by formula (G), without the ball. A voter's votes
  /// are weighted by its shares, so that dense places do not count twice. Sharper.
  bool second_pass = false;
  /// Voters are weighted by 1 / (number of points within sigma / 2, including themselves). Scan lines and rings, which
  /// are dense along and sparse across, then vote as a surface does.
  bool equalise_density = false;
  /// Instruction set: "avx512", "avx2" or "baseline"; by default the fastest of this machine. For comparisons.
  std::string kernel{};
};

/// The result of voting on a cloud. Skipped points get a tensor without votes.
struct CloudVotes {
  std::vector<kernels::TensorF> tensors;                ///< of every point, in the order of the cloud
  std::vector<kernels::DecompositionF> decompositions;  ///< of these tensors
  std::size_t not_finite = 0;                           ///< points that were skipped
  std::size_t too_far = 0;  ///< skipped: kMaxUnits of StepCloud or more from the middle (131 km at sigma 0.3)
  std::size_t num_voters = 0;
  /// m: the edge of the voxels in which one point votes for all. Larger than requested (sigma / 8) where points are so
  /// dense that voting would take too long.
  double voxel = 0;
};

/// Votes on one cloud after another. Keeps its memory and that of the votes in between: allocating memory costs as much
/// as the votes of a small cloud. One thread at a time.
class BatchVoter {
 public:
  BatchVoter();
  ~BatchVoter();
  BatchVoter(BatchVoter&&) noexcept;
  BatchVoter& operator=(BatchVoter&&) noexcept;

  /// The same as vote_cloud(); replaces the content of `votes`.
  void vote(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters, int threads,
            const BatchOptions& options, CloudVotes& votes);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

/// Ball votes of all points for all points. With a voxel, the first point in each voxel votes, and the others take its
/// tensor. In float, exact to 1e-5 of a tensor's norm; the bits do not depend on `threads`. Throws
/// std::invalid_argument on invalid parameters.
[[nodiscard]] CloudVotes vote_cloud(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters,
                                    int threads = 1, const BatchOptions& options = {});

}  // namespace curbstone::tensor_voting::voting
