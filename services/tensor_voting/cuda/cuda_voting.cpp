#include "services/tensor_voting/cuda/cuda_voting.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/statistics/quantile.hpp"
#include "services/tensor_voting/cuda/cloud_request.hpp"
#include "services/tensor_voting/voting/step_cloud.hpp"

namespace curbstone::tensor_voting::cuda {

namespace {

/// Floating-point operations of a tested pair: an offset and its square; and of a pair that votes: the exponent, exp2,
/// a quotient, two products and six sums. A fused multiply-add counts as two.
constexpr double kFlopsPerTest = 8;
constexpr double kFlopsPerVote = 16;

std::uint32_t checked_size(std::size_t size) {
  if (size > std::numeric_limits<std::int32_t>::max()) {
    throw std::invalid_argument(std::to_string(size) + " points: expected at most 2^31 - 1");
  }
  return static_cast<std::uint32_t>(size);
}

/// The origin that to_steps() would find. A sample of the points suffices, because to_steps() uses only a sample too.
Eigen::Vector3d find_middle(std::span<const Eigen::Vector3d> points, double sigma) {
  constexpr std::size_t kSample = 1000;
  std::vector<Eigen::Vector3d> sample;
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / kSample) {
    if (points[i].allFinite()) sample.push_back(points[i]);
  }
  if (sample.empty()) {
    const auto finite = std::find_if(points.begin(), points.end(), [](const auto& p) { return p.allFinite(); });
    if (finite != points.end()) sample.push_back(*finite);
  }
  return voting::to_steps(sample, sigma).origin;
}

}  // namespace

BatchRequest request_for(std::span<const Eigen::Vector3d> points, const voting::VotingParameters& parameters,
                         const voting::BatchOptions& options) {
  voting::validate(parameters);
  const Eigen::Vector3d m = find_middle(points, parameters.sigma);
  return {parameters, {m.x(), m.y(), m.z()}, options.second_pass, options.equalise_density};
}

void move_result(BatchOutput& output, voting::CloudVotes& votes) {
  std::swap(votes.tensors, output.tensors);
  votes.decompositions.resize(output.shapes.size());
  for (std::size_t i = 0; i < output.shapes.size(); ++i) {
    const VotedShape& s = output.shapes[i];
    votes.decompositions[i] = {{s.normal[0], s.normal[1], s.normal[2]},
                               {s.tangent[0], s.tangent[1], s.tangent[2]},
                               s.stick,
                               s.plate,
                               s.ball,
                               s.mass};
  }
  votes.not_finite = output.counts.not_finite;
  votes.too_far = output.counts.too_far;
  votes.num_voters = output.counts.voters;
  votes.voxel = output.counts.voxel;
}

std::string why_no_cuda() {
  return why_no_device();
}

CudaBatchVoter::CudaBatchVoter() : CudaBatchVoter(make_cloud_batch) {}
CudaBatchVoter::CudaBatchVoter(const MakeBatch& make_batch)
    : batch_(make_batch()), output_(std::make_unique<BatchOutput>()) {}
CudaBatchVoter::~CudaBatchVoter() = default;
CudaBatchVoter::CudaBatchVoter(CudaBatchVoter&&) noexcept = default;
CudaBatchVoter& CudaBatchVoter::operator=(CudaBatchVoter&&) noexcept = default;

void CudaBatchVoter::vote(std::span<const Eigen::Vector3d> points, const voting::VotingParameters& parameters,
                          const voting::BatchOptions& options, voting::CloudVotes& votes) {
  const BatchRequest request = request_for(points, parameters, options);
  batch_->vote(points.empty() ? nullptr : points[0].data(), checked_size(points.size()), request, *output_);
  move_result(*output_, votes);
}

voting::CloudVotes vote_cloud_cuda(std::span<const Eigen::Vector3d> points, const voting::VotingParameters& parameters,
                                   const voting::BatchOptions& options) {
  voting::CloudVotes votes;
  CudaBatchVoter().vote(points, parameters, options, votes);
  return votes;
}

std::optional<CudaTimings> time_cuda_voting(std::span<const Eigen::Vector3d> points,
                                            const voting::VotingParameters& parameters, int repeats) {
  const BatchRequest request = request_for(points, parameters, {});
  const std::uint32_t size = checked_size(points.size());
  if (points.empty() || !cuda_available()) return std::nullopt;
  const TimedBatch timed = time_on_device(points[0].data(), size, request, std::max(repeats, 1));
  const auto median_of = [&](auto part) {
    std::vector<double> values;
    for (const DeviceTimes& run : timed.runs) values.push_back(part(run));
    return quantile_in_place(values, 0.5);
  };
  CudaTimings t;
  t.device = timed.device;
  t.upload_ms = median_of([](const auto& run) { return run.upload_ms; });
  t.sort_ms = median_of([](const auto& run) { return run.sort_ms; });
  t.vote_ms = median_of([](const auto& run) { return run.vote_ms; });
  t.download_ms = median_of([](const auto& run) { return run.download_ms; });
  t.total_ms = median_of([](const auto& run) { return run.upload_ms + run.sort_ms + run.vote_ms + run.download_ms; });
  std::vector<double> calls;
  CudaBatchVoter voter;
  voting::CloudVotes votes;
  for (int i = -2; i < std::max(repeats, 1); ++i) {  // the first two runs allocate memory
    const auto begin = std::chrono::steady_clock::now();
    voter.vote(points, parameters, {}, votes);
    if (i < 0) continue;
    calls.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  t.call_ms = quantile_in_place(calls, 0.5);
  t.pairs_tested = timed.tests;
  t.pair_votes = timed.pair_votes;
  t.flops = kFlopsPerTest * static_cast<double>(t.pairs_tested) + kFlopsPerVote * static_cast<double>(t.pair_votes);
  t.bytes = static_cast<double>(timed.counts.voters) *
            (sizeof(std::uint64_t) + sizeof(kernels::StepPoint) + sizeof(kernels::TensorF) + sizeof(VotedShape));
  t.flops_floor_ms = 1e3 * t.flops / timed.device_flops_per_s;
  t.bytes_floor_ms = 1e3 * t.bytes / timed.device_bytes_per_s;
  return t;
}

}  // namespace curbstone::tensor_voting::cuda
