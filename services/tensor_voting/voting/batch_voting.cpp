#include "services/tensor_voting/voting/batch_voting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <stdexcept>
#include <string>
#include <utility>

#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/kernels/tensor_block.hpp"
#include "services/tensor_voting/voting/cell_list.hpp"
#include "services/tensor_voting/voting/parallel.hpp"
#include "services/tensor_voting/voting/step_cloud.hpp"
#include "services/tensor_voting/voting/thinning.hpp"

namespace curbstone::tensor_voting::voting {

namespace {

/// m. Beyond 16 sigma a vote is e^-256: nothing in float.
double cut_off(const VotingParameters& parameters) {
  return std::min(parameters.radius, 16 * parameters.sigma);
}

std::vector<WidePoint> voters_of(const StepCloud& cloud, const Thinning& thinning) {
  std::vector<WidePoint> voters(thinning.voters.size());
  for (std::size_t i = 0; i < voters.size(); ++i) voters[i] = cloud.points[thinning.voters[i]];
  return voters;
}

/// Blocks of voters that one thread deals with at a time.
constexpr std::size_t kBlocksAtOnce = 16;

/// The voters sorted by cell, with whatever they need to vote.
class Assembly {
 public:
  using Vote = decltype(kernels::BatchKernel::ball);

  Assembly(std::span<const WidePoint> voters, double radius_in_steps, int threads)
      : cells_(voters, edge_for(radius_in_steps / 2), threads), reach_(2), threads_(threads) {
    // Cells of half the radius look at the fewest voters out of reach. But a block of votees is of one cell: where
    // points are few, larger cells fill it better. The map is made of surfaces: twice the edge, four times the points.
    constexpr double kEnough = kernels::kBlock;
    const double occupancy = static_cast<double>(voters.size()) / static_cast<double>(cells_.cells().size());
    if (occupancy < kEnough) {
      const double edge = radius_in_steps * (4 * occupancy >= kEnough ? 1 : 16 * occupancy >= kEnough ? 2 : 4);
      cells_ = CellList(voters, edge_for(edge), threads);
      reach_ = 1;
    }
    arrays_ = cells_.arrays();
  }

  [[nodiscard]] const CellList& cells() const { return cells_; }
  [[nodiscard]] bool crowded(double most) const { return cells_.crowded(reach_, most); }
  void weigh(const std::vector<float>& weights) { arrays_.weight = weights.data(); }
  void orient(const std::vector<kernels::OrientedVoter>& voters) { arrays_.oriented = voters.data(); }

  /// Has every block of voters voted for. `take(blocks, votes)` is called by any thread, for a few blocks at a time.
  template <class Take>
  void run(Vote vote, const kernels::BatchScale& scale, const Take& take) const {
    const auto& blocks = cells_.blocks();
    parallel_for(blocks.size(), kBlocksAtOnce, threads_, [&](std::size_t begin, std::size_t end) {
      std::vector<kernels::VoterRun> runs;
      std::array<kernels::BlockVotes, kBlocksAtOnce> votes;
      for (std::size_t i = begin; i < end; ++i) {
        const CellList::Block& block = blocks[i];
        if (i == begin || block.cell != blocks[i - 1].cell) {
          runs.clear();
          cells_.runs_around(cells_.cells()[block.cell], reach_, runs);
        }
        vote(arrays_, runs.data(), runs.size(), block.begin, block.count, scale, votes[i - begin].sum);
      }
      take(std::span(blocks).subspan(begin, end - begin), std::span(votes).first(end - begin));
    });
  }

 private:
  static std::int32_t edge_for(double steps) {
    return std::max(CellList::kMinEdge, static_cast<std::int32_t>(std::min(std::ceil(steps) + 1, double{1 << 29})));
  }

  CellList cells_;
  kernels::VoterArrays arrays_{};
  int reach_;  // cells
  int threads_;
};

static_assert(kernels::kBlock == kernels::kLanes);

kernels::TensorBlock from_ball_votes(const kernels::BlockVotes& votes, float ball) {
  kernels::TensorBlock t;
  for (int lane = 0; lane < kernels::kBlock; ++lane) {
    const auto sum = [&](int c) { return votes.sum[c * kernels::kBlock + lane]; };  // w, then w u u^T
    const float w = sum(0);
    const float components[] = {w - ball * sum(1), -ball * sum(2), -ball * sum(3),
                                w - ball * sum(4), -ball * sum(5), w - ball * (w - sum(1) - sum(4))};
    for (int c = 0; c < 6; ++c) t.component[c * kernels::kBlock + lane] = components[c];
    t.mass[lane] = w;
  }
  return t;
}

kernels::TensorBlock from_oriented_votes(const kernels::BlockVotes& votes) {
  kernels::TensorBlock t;
  std::copy_n(votes.sum, kernels::kBlock, t.mass);
  std::copy_n(votes.sum + kernels::kBlock, 6 * kernels::kBlock, t.component);
  return t;
}

/// Of each voter, in the order in which voters were given.
struct VoterResults {
  std::vector<kernels::TensorF> tensors;
  std::vector<kernels::DecompositionF> decompositions;

  explicit VoterResults(std::size_t size) : tensors(size), decompositions(size) {}

  void take(const CellList& cells, std::span<const CellList::Block> blocks,
            std::span<const kernels::TensorBlock> of_blocks) {
    std::array<kernels::ShapeBlock, kBlocksAtOnce> shapes;
    kernels::decompose(of_blocks, shapes);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (std::size_t lane = 0; lane < blocks[i].count; ++lane) {
        const std::uint32_t voter = cells.source()[blocks[i].begin + lane];
        tensors[voter] = of_blocks[i].get(lane);
        decompositions[voter] = shapes[i].get(lane, of_blocks[i].mass[lane]);
      }
    }
  }
};

/// 1 / (number of voters within half a sigma), in the order of the cells.
std::vector<float> density_weights(const Assembly& assembly, float half_sigma, const kernels::BatchKernel& kernel) {
  std::vector<float> weights(assembly.cells().source().size());
  assembly.run(kernel.count, {0, half_sigma}, [&](auto blocks, auto votes) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (std::size_t lane = 0; lane < blocks[i].count; ++lane) {
        weights[blocks[i].begin + lane] = 1 / votes[i].sum[lane];
      }
    }
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

Assembly assemble(const StepCloud& cloud, const Thinning& thinning, const VotingParameters& parameters,
                  const BatchOptions& options, int threads) {
  // Density equalised over sigma / 2 must see that far even where the cut-off is nearer.
  const double radius = std::max(cut_off(parameters), options.equalise_density ? parameters.sigma / 2 : 0.0);
  const bool all = thinning.voters.size() == cloud.points.size();
  const std::vector<WidePoint> some = all ? std::vector<WidePoint>() : voters_of(cloud, thinning);
  return {std::span(all ? cloud.points : some), radius / cloud.step, threads};
}

VoterResults vote(Assembly& assembly, const StepCloud& cloud, const VotingParameters& parameters,
                  const BatchOptions& options, VoterResults results) {
  const kernels::BatchKernel& kernel = kernels::batch_kernels()[0];
  const double unit = cloud.unit;
  const kernels::BatchScale scale{static_cast<float>(unit * unit / (parameters.sigma * parameters.sigma)),
                                  static_cast<float>(cut_off(parameters) / unit)};
  const CellList& cells = assembly.cells();

  std::vector<float> weights;
  if (options.equalise_density) {
    weights = density_weights(assembly, static_cast<float>(parameters.sigma / 2 / unit), kernel);
    assembly.weigh(weights);
  }
  assembly.run(kernel.ball, scale, [&](auto blocks, auto votes) {
    std::array<kernels::TensorBlock, kBlocksAtOnce> tensors;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      tensors[i] = from_ball_votes(votes[i], static_cast<float>(parameters.ball));
    }
    results.take(cells, blocks, std::span(tensors).first(blocks.size()));
  });
  if (!options.second_pass) return results;

  const std::vector<kernels::OrientedVoter> oriented = oriented_voters(cells, results);
  assembly.orient(oriented);
  assembly.run(kernel.oriented, scale, [&](auto blocks, auto votes) {
    std::array<kernels::TensorBlock, kBlocksAtOnce> tensors;
    for (std::size_t i = 0; i < blocks.size(); ++i) tensors[i] = from_oriented_votes(votes[i]);
    results.take(cells, blocks, std::span(tensors).first(blocks.size()));
  });
  return results;
}

}  // namespace

CloudVotes vote_cloud(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters, int threads,
                      const BatchOptions& options) {
  validate(parameters);
  if (parameters.voxel > 0 && parameters.voxel < parameters.sigma / 64) {
    throw std::invalid_argument("voxel = " + std::to_string(parameters.voxel) +
                                ": expected 0 (no thinning) or at least sigma / 64");
  }
  const StepCloud cloud = to_steps(points, parameters.sigma);
  CloudVotes votes;
  votes.not_finite = cloud.not_finite;
  votes.too_far = cloud.too_far;
  votes.voxel = parameters.voxel;
  if (cloud.points.empty()) {
    votes.tensors.resize(points.size());
    votes.decompositions.resize(points.size());
    return votes;
  }

  Thinning thinning = votes.voxel > 0 ? first_in_voxel(cloud, votes.voxel) : keep_all(cloud.points.size());
  // Memory that nobody has touched yet takes as long to get as the points take to sort.
  const auto policy = threads > 1 ? std::launch::async : std::launch::deferred;
  auto room = std::async(policy, [size = thinning.voters.size()] { return VoterResults(size); });
  Assembly assembly = assemble(cloud, thinning, parameters, options, threads);
  constexpr double kMostTests = 50'000;
  const double coarse = parameters.sigma / 8;
  if (votes.voxel < coarse && assembly.crowded(kMostTests)) {
    votes.voxel = coarse;
    thinning = first_in_voxel(cloud, coarse);
    assembly = assemble(cloud, thinning, parameters, options, threads);
  }
  VoterResults results = vote(assembly, cloud, parameters, options, room.get());
  votes.num_voters = thinning.voters.size();
  if (votes.num_voters == points.size()) {  // voter by voter is point by point
    votes.tensors = std::move(results.tensors);
    votes.decompositions = std::move(results.decompositions);
    return votes;
  }
  votes.tensors.resize(points.size());
  votes.decompositions.resize(points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::uint32_t voter = thinning.voter_of_point[i];
    votes.tensors[cloud.source[i]] = results.tensors[voter];
    votes.decompositions[cloud.source[i]] = results.decompositions[voter];
  }
  return votes;
}

std::vector<CloudVotes> vote_scales(std::span<const Eigen::Vector3d> points, std::span<const VotingParameters> scales,
                                    int threads, const BatchOptions& options) {
  std::vector<CloudVotes> votes;
  for (const VotingParameters& scale : scales) votes.push_back(vote_cloud(points, scale, threads, options));
  return votes;
}

}  // namespace curbstone::tensor_voting::voting
