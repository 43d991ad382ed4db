#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "services/tensor_voting/cuda/batch_steps.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::tensor_voting::cuda {

struct BatchRequest {
  voting::VotingParameters parameters;  ///< must be valid
  double middle[3] = {0, 0, 0};         ///< m: centre of the cloud, the origin of the steps
  bool second_pass = false;
  bool equalise_density = false;
};

struct BatchCounts {
  std::uint32_t voters = 0;
  std::uint32_t not_finite = 0;
  std::uint32_t too_far = 0;
  double voxel = 0;  ///< m
};

/// Results for every point, in the order of the cloud.
struct BatchOutput {
  std::vector<kernels::TensorF> tensors;
  std::vector<VotedShape> shapes;
  BatchCounts counts;
};

/// Votes on one cloud after another. Throws std::runtime_error when the machine fails.
class CloudBatch {
 public:
  virtual ~CloudBatch() = default;
  /// `xyz`: m, of `num_points` points. The memory of `output` is reused.
  virtual void vote(const double* xyz, std::uint32_t num_points, const BatchRequest& request, BatchOutput& output) = 0;
};

/// Batch voting on a machine: a GPU (cuda_machine.cuh), or the host in its place (tests). A machine has
///   Array<T>                         its memory: data(); allocate<T>(n), upload(from, n), download(array, n, to)
///   sort(keys, values, n)            stable, in place
///   for_each(n, f), for_each_window(n, f)
/// Call upload(), prepare(), vote(), download() in this order.
template <class Machine>
class BatchPipeline {
 public:
  template <class T>
  using Array = typename Machine::template Array<T>;

  explicit BatchPipeline(Machine& machine) : machine_(machine) {}

  void upload(const double* xyz, std::uint32_t num_points) {
    n_ = num_points;
    xyz_ = machine_.upload(xyz, 3 * std::size_t{num_points});
  }

  /// Computes the points' cells, thins the points and sorts them by cell. Points so dense that voting would take too
  /// long are thinned more than requested.
  void prepare(const BatchRequest& request) {
    request_ = request;
    const voting::VotingParameters& p = request.parameters;
    steps_per_metre_ = kStepsPerUnit / std::exp2(std::floor(std::log2(p.sigma)));
    // Beyond 12 sigma a vote is zero in float. Density equalisation over sigma / 2 needs at least that radius.
    radius_ = std::min(p.radius, 12 * p.sigma);
    const double reach = request.equalise_density ? std::max(radius_, p.sigma / 2) : radius_;
    grid_ = CellGrid::for_radius(reach * steps_per_metre_, (1 << 17) + 1, (1 << 20) + 1);  // for PlacePoints::kFar
    sort_voters(p.voxel);
    const double coarse = p.sigma / 8;
    if (p.voxel < coarse && count_tests() > kMaxTests * std::uint64_t{counts_.voters}) sort_voters(coarse);
  }

  void vote() {
    if (request_.equalise_density) weigh();
    request_.equalise_density ? pass<BallVotes<true>>() : pass<BallVotes<false>>();
    if (request_.second_pass) request_.equalise_density ? pass<OrientedVotes<true>>() : pass<OrientedVotes<false>>();
  }

  /// Results in the order of the cloud.
  void download(std::vector<kernels::TensorF>& tensors, std::vector<VotedShape>& shapes) {
    Array<kernels::TensorF> all_tensors = machine_.template allocate<kernels::TensorF>(n_);
    Array<VotedShape> all_shapes = machine_.template allocate<VotedShape>(n_);
    machine_.for_each(n_, ScatterResults{voter_of_.data(), rank_.data(), tensors_.data(), shapes_.data(),
                                         all_tensors.data(), all_shapes.data()});
    tensors.resize(n_);
    shapes.resize(n_);
    machine_.download(all_tensors, n_, tensors.data());
    machine_.download(all_shapes, n_, shapes.data());
  }

  [[nodiscard]] const BatchCounts& counts() const { return counts_; }

  /// Number of pairs tested in one pass.
  [[nodiscard]] std::uint64_t count_tests() {
    const std::uint32_t windows = num_windows(counts_.voters);
    auto tests = machine_.template allocate<std::uint64_t>(windows);
    machine_.for_each_window(windows, CountTests{grid_, sorted(), tests.data()});
    std::vector<std::uint64_t> host(windows);
    machine_.download(tests, windows, host.data());
    return std::accumulate(host.begin(), host.end(), std::uint64_t{0});
  }

  /// Number of votes cast: ordered pairs within reach of each other, except pairs at the same place.
  [[nodiscard]] std::uint64_t count_pair_votes() {
    Array<std::uint32_t> counts = machine_.template allocate<std::uint32_t>(counts_.voters);
    CountVotes votes{{voters_.data()}, radius2(), false, counts.data(), nullptr};
    gather(votes);
    std::vector<std::uint32_t> host(counts_.voters);
    machine_.download(counts, counts_.voters, host.data());
    return std::accumulate(host.begin(), host.end(), std::uint64_t{0});
  }

 private:
  static constexpr double kStepsPerUnit = 1 << 20;    // as in StepCloud
  static constexpr std::uint64_t kMaxTests = 50'000;  // for one voter, on average

  [[nodiscard]] float in_steps2(double length) const {
    return static_cast<float>(length * length * steps_per_metre_ * steps_per_metre_);
  }
  [[nodiscard]] float radius2() const { return in_steps2(radius_); }

  [[nodiscard]] CloudFrame frame(double voxel) const {
    CloudFrame frame;
    frame.steps_per_metre = steps_per_metre_;
    for (int axis = 0; axis < 3; ++axis) frame.origin[axis] = request_.middle[axis];
    if (voxel <= 0) return frame;
    frame.voxels_per_step = 1 / steps_per_metre_ / voxel;
    for (int axis = 0; axis < 3; ++axis) {
      const double in_voxels = request_.middle[axis] / voxel;
      frame.origin_in_voxel[axis] = in_voxels - std::floor(in_voxels);
    }
    return frame;
  }

  void sort_voters(double voxel) {
    counts_ = {};
    counts_.voxel = voxel;
    auto points = machine_.template allocate<kernels::StepPoint>(n_);
    auto order = machine_.template allocate<std::uint32_t>(n_);
    cells_ = machine_.template allocate<std::uint64_t>(n_);
    voter_of_ = machine_.template allocate<std::uint32_t>(n_);
    auto voxels = machine_.template allocate<std::uint64_t>(voxel > 0 ? n_ : 0);
    const PlacePoints place{xyz_.data(),
                            frame(voxel),
                            grid_,
                            points.data(),
                            order.data(),
                            cells_.data(),
                            voxel > 0 ? voxels.data() : nullptr,
                            voter_of_.data()};
    machine_.for_each(n_, place);
    if (voxel > 0) {
      auto by_voxel = machine_.template allocate<std::uint32_t>(n_);
      machine_.copy(order, n_, by_voxel);
      machine_.sort(voxels, by_voxel, n_);
      machine_.for_each(n_, ThinOut{voxels.data(), by_voxel.data(), n_, cells_.data(), voter_of_.data()});
    }
    machine_.sort(cells_, order, n_);

    auto kinds = machine_.template allocate<std::uint32_t>(3);
    machine_.for_each(1, CountKinds{cells_.data(), n_, kinds.data()});
    std::uint32_t numbers[3];
    machine_.download(kinds, 3, numbers);
    counts_.voters = numbers[0];
    counts_.not_finite = numbers[1];
    counts_.too_far = numbers[2];

    voters_ = machine_.template allocate<kernels::StepPoint>(counts_.voters);
    rank_ = machine_.template allocate<std::uint32_t>(n_);
    machine_.for_each(counts_.voters, OrderVoters{points.data(), order.data(), voters_.data(), rank_.data()});
  }

  [[nodiscard]] SortedKeys sorted() const { return {cells_.data(), counts_.voters}; }

  template <class Votes>
  void gather(const Votes& votes) {
    machine_.for_each_window(kParts * num_windows(counts_.voters),
                             GatherWindow<Votes>{grid_, sorted(), sorted(), votes});
  }

  void weigh() {
    weights_ = machine_.template allocate<float>(counts_.voters);
    gather(CountVotes{{voters_.data()}, in_steps2(request_.parameters.sigma / 2), true, nullptr, weights_.data()});
  }

  template <class Votes>
  void pass() {
    const voting::VotingParameters& p = request_.parameters;
    auto tensors = machine_.template allocate<kernels::TensorF>(counts_.voters);
    auto shapes = machine_.template allocate<VotedShape>(counts_.voters);
    Votes votes;
    votes.points = voters_.data();
    votes.decay = {static_cast<float>(-std::numbers::log2e / (p.sigma * p.sigma * steps_per_metre_ * steps_per_metre_)),
                   radius2()};
    if constexpr (requires { votes.ball; }) {
      votes.ball = static_cast<float>(p.ball);
    } else {
      votes.oriented = shapes_.data();
    }
    votes.weights = weights_.data();
    votes.tensors = tensors.data();
    votes.shapes = shapes.data();
    gather(votes);
    tensors_ = std::move(tensors);
    shapes_ = std::move(shapes);
  }

  Machine& machine_;
  BatchRequest request_;
  BatchCounts counts_;
  CellGrid grid_;
  std::uint32_t n_ = 0;
  double radius_ = 0;  // m
  double steps_per_metre_ = 1;
  Array<double> xyz_;
  Array<std::uint64_t> cells_;        // sorted
  Array<std::uint32_t> voter_of_;     // for each point, its voter
  Array<std::uint32_t> rank_;         // of a point that votes
  Array<kernels::StepPoint> voters_;  // in the order of cells_
  Array<float> weights_;
  Array<kernels::TensorF> tensors_;  // of voters
  Array<VotedShape> shapes_;
};

template <class Machine>
class CloudBatchOn : public CloudBatch {
 public:
  explicit CloudBatchOn(Machine machine) : machine_(std::move(machine)) {}

  void vote(const double* xyz, std::uint32_t num_points, const BatchRequest& request, BatchOutput& output) override {
    pipeline_.upload(xyz, num_points);
    pipeline_.prepare(request);
    pipeline_.vote();
    pipeline_.download(output.tensors, output.shapes);
    output.counts = pipeline_.counts();
  }

 private:
  Machine machine_;
  BatchPipeline<Machine> pipeline_{machine_};
};

}  // namespace curbstone::tensor_voting::cuda
