#include "services/tensor_voting/voting/batch_voting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/parallel/parallel_for.hpp"
#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/kernels/instruction_sets.hpp"
#include "services/tensor_voting/kernels/tensor_block.hpp"
#include "services/tensor_voting/voting/cell_list.hpp"
#include "services/tensor_voting/voting/step_cloud.hpp"
#include "services/tensor_voting/voting/thinning.hpp"

namespace curbstone::tensor_voting::voting {

namespace {

/// m. Beyond 16 sigma a vote is e^-256, which is zero in float.
double cut_off(const VotingParameters& parameters) {
  return std::min(parameters.radius, 16 * parameters.sigma);
}

/// Number of blocks of votees that one thread processes at a time.
constexpr std::size_t kBlocksAtOnce = 32;

/// The votes received by neighbours in the order of the cells: component after component, as in BlockVotes.
struct Received {
  static constexpr std::size_t kMaxReceivers = kBlocksAtOnce * kernels::kBlock;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::array<std::array<float, kMaxReceivers + kernels::kBlock>, 7> sum;

  void append(const kernels::BlockVotes& votes, std::uint32_t num_votees) {
    for (std::size_t c = 0; c < sum.size(); ++c) {
      std::copy_n(votes.sum + c * kernels::kBlock, kernels::kBlock, sum[c].begin() + count);  // the next overwrites
    }
    count += num_votees;
  }
};

/// The voters sorted by cell, with the data that they need to vote.
class Assembly {
 public:
  using Vote = decltype(kernels::BatchKernel::ball);

  Assembly(CellList& cells, std::span<const WidePoint> voters, double radius_in_steps, int threads)
      : cells_(&cells), reach_(2), threads_(threads) {
    cells.divide(voters, edge_for(radius_in_steps / 2));
    // Cells of half the radius test the fewest voters out of reach. But all votees of a block are of one cell: where
    // points are few, larger cells fill it better. Points of a map lie on surfaces: twice the edge gives four times the
    // points.
    constexpr double kEnough = 2 * kernels::kBlock;
    const double occupancy = static_cast<double>(voters.size()) / static_cast<double>(cells_->cells().size());
    if (occupancy < kEnough) {
      const double edge = radius_in_steps * (4 * occupancy >= kEnough ? 1 : 16 * occupancy >= kEnough ? 2 : 4);
      cells.divide(voters, edge_for(edge));
      reach_ = 1;
    }
    cells.fill(voters, threads);
    arrays_ = cells_->arrays();
  }

  [[nodiscard]] const CellList& cells() const { return *cells_; }
  [[nodiscard]] bool crowded(double most) const { return cells_->crowded(reach_, most); }
  void weigh(const std::vector<float>& weights) { arrays_.weight = weights.data(); }
  void orient(const std::vector<kernels::OrientedVoter>& voters) { arrays_.oriented = voters.data(); }

  /// Computes the votes for every voter. `take(received)` is called by any thread, for a few neighbours at a time.
  template <class Take>
  void run(Vote vote, const kernels::BatchScale& scale, const Take& take) const {
    const auto& blocks = cells_->blocks();
    parallel_for(blocks.size(), kBlocksAtOnce, threads_, [&](std::size_t begin, std::size_t end) {
      std::vector<kernels::VoterRun> runs;
      kernels::BlockVotes votes;
      Received received;
      received.first = blocks[begin].begin;
      for (std::size_t i = begin; i < end; ++i) {
        const CellList::Block& block = blocks[i];
        if (i == begin || block.cell != blocks[i - 1].cell) {
          runs.clear();
          cells_->runs_around(cells_->cells()[block.cell], reach_, runs);
        }
        vote(arrays_, runs.data(), runs.size(), block.begin, block.count, scale, votes.sum);
        received.append(votes, block.count);
      }
      take(received);
    });
  }

 private:
  static std::int32_t edge_for(double steps) {
    return std::max(CellList::kMinEdge, static_cast<std::int32_t>(std::min(std::ceil(steps) + 1, double{1 << 29})));
  }

  const CellList* cells_;
  kernels::VoterArrays arrays_{};
  int reach_;  // cells
  int threads_;
};

constexpr std::size_t kTensorBlocks = (Received::kMaxReceivers + kernels::kLanes - 1) / kernels::kLanes;
using Tensors = std::array<kernels::TensorBlock, kTensorBlocks>;

std::size_t num_blocks(const Received& received) {
  return (received.count + kernels::kLanes - 1) / kernels::kLanes;
}

Tensors from_ball_votes(const Received& received, float ball) {
  Tensors tensors;
  for (std::size_t block = 0; block < num_blocks(received); ++block) {
    kernels::TensorBlock& t = tensors[block];
    for (std::size_t lane = 0; lane < kernels::kLanes; ++lane) {
      const auto sum = [&](std::size_t c) { return received.sum[c][block * kernels::kLanes + lane]; };
      const float w = sum(0);  // the sums of w u u^T follow
      const float components[] = {w - ball * sum(1), -ball * sum(2), -ball * sum(3),
                                  w - ball * sum(4), -ball * sum(5), w - ball * (w - sum(1) - sum(4))};
      for (std::size_t c = 0; c < 6; ++c) t.component[c * kernels::kLanes + lane] = components[c];
      t.mass[lane] = w;
    }
  }
  return tensors;
}

Tensors from_oriented_votes(const Received& received) {
  Tensors tensors;
  for (std::size_t block = 0; block < num_blocks(received); ++block) {
    const auto copy = [&](std::size_t c, float* to) {
      std::copy_n(received.sum[c].begin() + static_cast<std::ptrdiff_t>(block * kernels::kLanes), kernels::kLanes, to);
    };
    copy(0, tensors[block].mass);
    for (std::size_t c = 0; c < 6; ++c) copy(c + 1, tensors[block].component + c * kernels::kLanes);
  }
  return tensors;
}

/// The results of each voter, in the order in which the voters were given.
struct VoterResults {
  std::span<kernels::TensorF> tensors;
  std::span<kernels::DecompositionF> decompositions;
  const kernels::VoteKernel& kernel;  // decomposes the tensors

  void take(const CellList& cells, const Received& received, const Tensors& of_blocks) const {
    std::array<kernels::ShapeBlock, kTensorBlocks> shapes;
    kernels::decompose(std::span(of_blocks).first(num_blocks(received)), shapes, kernel);
    for (std::size_t i = 0; i < received.count; ++i) {
      const std::uint32_t voter = cells.source()[received.first + i];
      const kernels::TensorBlock& block = of_blocks[i / kernels::kLanes];
      tensors[voter] = block.get(i % kernels::kLanes);
      decompositions[voter] = shapes[i / kernels::kLanes].get(i % kernels::kLanes, tensors[voter].mass);
    }
  }
};

/// 1 / (number of voters within half a sigma), in the order of the cells.
std::vector<float> density_weights(const Assembly& assembly, float half_sigma, const kernels::BatchKernel& kernel) {
  std::vector<float> weights(assembly.cells().source().size());
  assembly.run(kernel.count, {0, half_sigma}, [&](const Received& received) {
    for (std::size_t i = 0; i < received.count; ++i) weights[received.first + i] = 1 / received.sum[0][i];
  });
  return weights;
}

std::vector<kernels::OrientedVoter> oriented_voters(const CellList& cells, const VoterResults& results) {
  std::vector<kernels::OrientedVoter> oriented;
  oriented.reserve(cells.source().size());
  for (const std::uint32_t voter : cells.source()) {
    const kernels::DecompositionF& d = results.decompositions[voter];
    oriented.push_back(
        {{d.normal.x(), d.normal.y(), d.normal.z()}, d.stick, {d.tangent.x(), d.tangent.y(), d.tangent.z()}, d.plate});
  }
  return oriented;
}

void vote_all(Assembly& assembly, const StepCloud& cloud, const VotingParameters& parameters,
              const BatchOptions& options, const VoterResults& results) {
  const kernels::BatchKernel& kernel = kernels::kernel_for(kernels::batch_kernels(), options.kernel);
  const double unit = cloud.unit;
  const kernels::BatchScale scale{static_cast<float>(unit * unit / (parameters.sigma * parameters.sigma)),
                                  static_cast<float>(cut_off(parameters) / unit)};
  const CellList& cells = assembly.cells();

  std::vector<float> weights;
  if (options.equalise_density) {
    weights = density_weights(assembly, static_cast<float>(parameters.sigma / 2 / unit), kernel);
    assembly.weigh(weights);
  }
  assembly.run(kernel.ball, scale, [&](const Received& received) {
    results.take(cells, received, from_ball_votes(received, static_cast<float>(parameters.ball)));
  });
  if (!options.second_pass) return;

  const std::vector<kernels::OrientedVoter> oriented = oriented_voters(cells, results);
  assembly.orient(oriented);
  assembly.run(kernel.oriented, scale,
               [&](const Received& received) { results.take(cells, received, from_oriented_votes(received)); });
}

void require_voxel(const VotingParameters& parameters) {
  if (parameters.voxel > 0 && parameters.voxel < parameters.sigma / 64) {
    throw std::invalid_argument("voxel = " + std::to_string(parameters.voxel) +
                                ": expected 0 (no thinning) or at least sigma / 64");
  }
}

/// Makes room for the results in a thread of its own, if it is worth one: memory that was never touched takes as long
/// to get as sorting the points.
std::future<void> begin_results(CloudVotes& votes, std::size_t num_points, int threads) {
  const bool at_hand = votes.tensors.capacity() >= num_points && votes.decompositions.capacity() >= num_points;
  return std::async(threads > 1 && !at_hand ? std::launch::async : std::launch::deferred, [&votes, num_points] {
    votes.tensors.resize(num_points);
    votes.decompositions.resize(num_points);
  });
}

void clear_results(CloudVotes& votes, std::size_t num_points) {
  votes.tensors.assign(num_points, {});
  votes.decompositions.assign(num_points, {});
}

}  // namespace

/// The working memory of a vote, kept for the next one.
struct BatchVoter::Scratch {
  StepCloud cloud;
  std::optional<Thinning> thinning;  // nothing: every point votes
  std::vector<WidePoint> voters;     // used with thinning
  CellList cells;
  std::vector<kernels::TensorF> tensors;  // of the voters, if not every point votes
  std::vector<kernels::DecompositionF> decompositions;

  void thin(double voxel) {
    thinning.reset();
    voters.clear();
    if (voxel <= 0) return;
    thinning = first_in_voxel(cloud, voxel);
    for (const std::uint32_t i : thinning->voters) voters.push_back(cloud.points[i]);
  }
  Assembly assemble(const VotingParameters& parameters, const BatchOptions& options, int threads) {
    // Density equalisation over sigma / 2 needs at least that radius, even if the cut-off is shorter.
    const double radius = std::max(cut_off(parameters), options.equalise_density ? parameters.sigma / 2 : 0.0);
    return {cells, thinning ? voters : cloud.points, radius / cloud.step, threads};
  }
  /// Thins to `voxel` and assembles; with a larger voxel where points are so dense that each would test too many.
  Assembly assemble_sparse(const VotingParameters& parameters, const BatchOptions& options, int threads,
                           double& voxel) {
    constexpr double kMaxTests = 50'000;
    thin(voxel);
    Assembly assembly = assemble(parameters, options, threads);
    const double coarse = parameters.sigma / 8;
    if (voxel >= coarse || !assembly.crowded(kMaxTests)) return assembly;
    voxel = coarse;
    thin(voxel);
    return assemble(parameters, options, threads);
  }
  /// Copies the results of the voters to the points.
  void spread(CloudVotes& votes) const {
    for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
      const std::uint32_t voter = thinning ? thinning->voter_of_point[i] : i;
      votes.tensors[cloud.source[i]] = tensors[voter];
      votes.decompositions[cloud.source[i]] = decompositions[voter];
    }
  }
};

BatchVoter::BatchVoter() : scratch_(std::make_unique<Scratch>()) {}
BatchVoter::~BatchVoter() = default;
BatchVoter::BatchVoter(BatchVoter&&) noexcept = default;
BatchVoter& BatchVoter::operator=(BatchVoter&&) noexcept = default;

void BatchVoter::vote(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters, int threads,
                      const BatchOptions& options, CloudVotes& votes) {
  validate(parameters);
  require_voxel(parameters);
  const kernels::VoteKernel& kernel = kernels::kernel_for(kernels::vote_kernels(), options.kernel);
  std::future<void> room = begin_results(votes, points.size(), threads);
  Scratch& scratch = *scratch_;
  scratch.cloud = to_steps(points, parameters.sigma, std::move(scratch.cloud));
  votes.not_finite = scratch.cloud.not_finite;
  votes.too_far = scratch.cloud.too_far;
  votes.voxel = parameters.voxel;
  votes.num_voters = 0;
  if (scratch.cloud.points.empty()) {
    room.get();
    return clear_results(votes, points.size());
  }
  Assembly assembly = scratch.assemble_sparse(parameters, options, threads, votes.voxel);
  votes.num_voters = assembly.cells().source().size();
  room.get();
  if (votes.num_voters == points.size()) {  // voters and points are the same
    return vote_all(assembly, scratch.cloud, parameters, options, {votes.tensors, votes.decompositions, kernel});
  }
  scratch.tensors.resize(votes.num_voters);
  scratch.decompositions.resize(votes.num_voters);
  vote_all(assembly, scratch.cloud, parameters, options, {scratch.tensors, scratch.decompositions, kernel});
  clear_results(votes, points.size());
  scratch.spread(votes);
}

CloudVotes vote_cloud(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters, int threads,
                      const BatchOptions& options) {
  CloudVotes votes;
  BatchVoter().vote(points, parameters, threads, options, votes);
  return votes;
}

}  // namespace curbstone::tensor_voting::voting
