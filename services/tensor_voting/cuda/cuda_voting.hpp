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
/// Tensor voting on an NVIDIA GPU: the functions of batch_voting.hpp, with the same results to 1e-5 of a tensor's norm.
/// Optional: if it was built without nvcc, or if there is no device, every function here only reports the reason.

/// Why no device can be used; empty if one can.
[[nodiscard]] std::string why_no_cuda();
[[nodiscard]] inline bool cuda_available() {
  return why_no_cuda().empty();
}

class CloudBatch;
struct BatchOutput;

/// Votes on one cloud after another on the current device. Keeps its device and host memory in between, as
/// voting::BatchVoter does on the CPU: allocating memory costs more than the votes of most clouds. One thread at a
/// time.
class CudaBatchVoter {
 public:
  /// Makes the device's part. Tests replace it by the host.
  using MakeBatch = std::function<std::unique_ptr<CloudBatch>()>;

  /// Throws std::runtime_error if there is no device (why_no_cuda()).
  CudaBatchVoter();
  explicit CudaBatchVoter(const MakeBatch& make_batch);
  ~CudaBatchVoter();
  CudaBatchVoter(CudaBatchVoter&&) noexcept;
  CudaBatchVoter& operator=(CudaBatchVoter&&) noexcept;

  /// The same as vote_cloud_cuda(); replaces the content of `votes`.
  void vote(std::span<const Eigen::Vector3d> points, const voting::VotingParameters& parameters,
            const voting::BatchOptions& options, voting::CloudVotes& votes);

 private:
  std::unique_ptr<CloudBatch> batch_;
  std::unique_ptr<BatchOutput> output_;
};

/// vote_cloud() on the current device. Uploads the points, downloads 68 bytes a point, and needs less than 300 bytes of
/// device memory a point. The same device gives the same bits. The density limit (CloudVotes::voxel) differs a little
/// from that of vote_cloud(), because other pairs are tested. Throws std::invalid_argument as vote_cloud() does, and
/// std::runtime_error with CUDA's error text when there is no device, too little memory, or a failure. Any thread; each
/// call has a stream of its own.
[[nodiscard]] voting::CloudVotes vote_cloud_cuda(std::span<const Eigen::Vector3d> points,
                                                 const voting::VotingParameters& parameters,
                                                 const voting::BatchOptions& options = {});

/// The time of each part of a batch on the device, and the device's lower bounds for it.
struct CudaTimings {
  std::string device;
  // ms, each the median of the repeats. The first call, which loads code and allocates memory, is not counted.
  double upload_ms = 0;    ///< of the points
  double sort_ms = 0;      ///< thinning and the cell list
  double vote_ms = 0;      ///< votes and eigen-decomposition: the kernel
  double download_ms = 0;  ///< of tensors and decompositions
  double total_ms = 0;     ///< the median of their sums
  /// Of CudaBatchVoter::vote() as its caller sees it, with the results in their vectors.
  double call_ms = 0;

  std::uint64_t pairs_tested = 0;  ///< pairs of votee and voter, in reach or not
  std::uint64_t pair_votes = 0;    ///< within reach
  double flops = 0;                ///< minimum for those tests and votes
  double bytes = 0;                ///< minimum traffic of the device's memory: points in, results out
  /// The time for these at the device's peak rates, in ms: the kernel cannot be faster than the larger one.
  double flops_floor_ms = 0;
  double bytes_floor_ms = 0;
};
/// Returns nothing without a device or for an empty cloud. Throws what vote_cloud_cuda() throws.
[[nodiscard]] std::optional<CudaTimings> time_cuda_voting(std::span<const Eigen::Vector3d> points,
                                                          const voting::VotingParameters& parameters, int repeats = 5);

}  // namespace curbstone::tensor_voting::cuda
