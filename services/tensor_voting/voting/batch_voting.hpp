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
/// A whole cloud at once.

/// What can be asked for beyond one pass of ball votes.
struct BatchOptions {
  /// The tensors vote once more, now that they know which way they lie: stick and plate votes by formula (G), the ball
  /// left out. A voter's shares are the weights of its votes, so that dense places do not count twice. Sharper.
  bool second_pass = false;
  /// Voters weigh 1 / (number of points within sigma / 2, themselves included): scan lines and rings, dense along and
  /// sparse across, then vote as a surface does.
  bool equalise_density = false;
  /// Instruction set: "avx512", "avx2" or "baseline"; the fastest that this machine has, by default. For comparisons.
  std::string kernel{};
};

/// What a cloud's votes come to. Points that were skipped get a tensor without votes.
struct CloudVotes {
  std::vector<kernels::TensorF> tensors;                ///< of every point, in the order of the cloud
  std::vector<kernels::DecompositionF> decompositions;  ///< the same taken apart
  std::size_t not_finite = 0;                           ///< points that were skipped
  std::size_t too_far = 0;  ///< skipped: more than 2^18 sigma from the middle (131 km at sigma 0.3)
  std::size_t num_voters = 0;
  /// m: the voxel in which one point votes for all. More than was asked for (sigma / 8) where points lie so dense that
  /// voting would not end.
  double voxel = 0;
};

/// Votes on one cloud after another and keeps its memory, and that of the votes, in between: new memory costs as much
/// as a small cloud's votes. One thread at a time.
class BatchVoter {
 public:
  BatchVoter();
  ~BatchVoter();
  BatchVoter(BatchVoter&&) noexcept;
  BatchVoter& operator=(BatchVoter&&) noexcept;

  /// As vote_cloud(); what was in `votes` goes.
  void vote(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters, int threads,
            const BatchOptions& options, CloudVotes& votes);

 private:
  struct Room;
  std::unique_ptr<Room> room_;
};

/// Ball votes of all points for all. With a voxel, the first point in each cube of it votes, and the others take its
/// tensor. In float, to 1e-5 of a tensor's norm; the bits do not depend on `threads`. Throws std::invalid_argument on
/// parameters that mean nothing.
[[nodiscard]] CloudVotes vote_cloud(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters,
                                    int threads = 1, const BatchOptions& options = {});

/// The same at several scales.
[[nodiscard]] std::vector<CloudVotes> vote_scales(std::span<const Eigen::Vector3d> points,
                                                  std::span<const VotingParameters> scales, int threads = 1,
                                                  const BatchOptions& options = {});

}  // namespace curbstone::tensor_voting::voting
