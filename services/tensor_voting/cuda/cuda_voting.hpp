#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "services/tensor_voting/voting/batch_voting.hpp"

namespace curbstone::tensor_voting::cuda {

/// @file
/// Tensor voting on a GPU of NVIDIA's: what batch_voting.hpp does, with the same results to 1e-5 of a tensor's norm.
/// Optional: where there was no nvcc to build it, or where there is no device, everything here says why and nothing
/// else.

/// Empty where there is a device that can be used; otherwise why not.
[[nodiscard]] std::string why_no_cuda();
[[nodiscard]] inline bool cuda_available() {
  return why_no_cuda().empty();
}

class CloudBatch;
struct BatchOutput;

/// Votes on one cloud after another on the current device and keeps its memory there and here in between, as
/// voting::BatchVoter does on the CPU: new memory costs more than most clouds' votes. One thread at a time.
class CudaBatchVoter {
 public:
  /// The device's part. Tests put the host in its place.
  using MakeBatch = std::function<std::unique_ptr<CloudBatch>()>;

  /// Throws std::runtime_error where there is no device (why_no_cuda()).
  CudaBatchVoter();
  explicit CudaBatchVoter(const MakeBatch& make_batch);
  ~CudaBatchVoter();
  CudaBatchVoter(CudaBatchVoter&&) noexcept;
  CudaBatchVoter& operator=(CudaBatchVoter&&) noexcept;

  /// As vote_cloud_cuda(); what was in `votes` goes.
  void vote(std::span<const Eigen::Vector3d> points, const voting::VotingParameters& parameters,
            const voting::BatchOptions& options, voting::CloudVotes& votes);

 private:
  std::unique_ptr<CloudBatch> batch_;
  std::unique_ptr<BatchOutput> output_;
};

/// vote_cloud() on the current device: the points go up, 68 bytes a point come down, and less than 300 bytes a point
/// are needed there. The same device gives the same bits. What counts as too dense to vote (CloudVotes::voxel) differs
/// a little from vote_cloud(), as other pairs are looked at. Throws std::invalid_argument as vote_cloud() does, and
/// std::runtime_error, with what CUDA has to say, when there is no device, too little memory, or a failure. Any thread;
/// each call has a stream of its own.
[[nodiscard]] voting::CloudVotes vote_cloud_cuda(std::span<const Eigen::Vector3d> points,
                                                 const voting::VotingParameters& parameters,
                                                 const voting::BatchOptions& options = {});

/// Where the time of a batch on the device goes, and what the device could do at best.
struct CudaTimings {
  std::string device;
  // ms, each the median of the repeats; the first call, which loads code and memory, is not counted.
  double upload_ms = 0;    ///< of the points
  double sort_ms = 0;      ///< thinning and the cell list
  double vote_ms = 0;      ///< votes and eigen-decomposition: the kernel
  double download_ms = 0;  ///< of tensors and decompositions
  double total_ms = 0;     ///< the median of their sums
  /// Of CudaBatchVoter::vote() as its caller sees it, results in their vectors.
  double call_ms = 0;

  std::uint64_t pairs_tested = 0;  ///< of votee and voter, in reach or not
  std::uint64_t pair_votes = 0;    ///< within reach
  double flops = 0;                ///< what those tests and votes take at least
  double bytes = 0;                ///< that must go through the device's memory: points in, results out
  /// What the device's peak rates make of that, in ms: the kernel cannot be faster than the larger one.
  double flops_floor_ms = 0;
  double bytes_floor_ms = 0;
};
/// Nothing without a device or with an empty cloud. Throws what vote_cloud_cuda() throws.
[[nodiscard]] std::optional<CudaTimings> time_cuda_voting(std::span<const Eigen::Vector3d> points,
                                                          const voting::VotingParameters& parameters, int repeats = 5);

}  // namespace curbstone::tensor_voting::cuda
