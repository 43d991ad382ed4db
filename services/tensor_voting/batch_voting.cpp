#include "services/tensor_voting/batch_voting.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <thread>
#include <unordered_map>

namespace curbstone {

namespace {

/// Indices of cells or voxels, and a sort key with x fastest.
struct Lattice {
  std::int64_t edge;  // steps

  [[nodiscard]] std::int64_t index(std::int32_t v) const {
    const std::int64_t wide = v;
    return wide >= 0 ? wide / edge : -((-wide + edge - 1) / edge);
  }
};

struct Key {
  std::int64_t z, y, x;
  auto operator<=>(const Key&) const = default;
};
Key key_of(const Lattice& lattice, const StepPoint& p) {
  return {lattice.index(p.z), lattice.index(p.y), lattice.index(p.x)};
}

/// For each point the first point in its voxel, and the points that are first.
struct Thinning {
  std::vector<std::uint32_t> voter_of_point;  // index into voters
  std::vector<std::uint32_t> voters;          // index into points
};
Thinning thin(std::span<const StepPoint> points, std::int64_t voxel) {
  Thinning result;
  result.voter_of_point.resize(points.size());
  if (voxel <= 0) {
    result.voters.resize(points.size());
    std::iota(result.voters.begin(), result.voters.end(), 0U);
    result.voter_of_point = result.voters;
    return result;
  }
  std::vector<std::pair<Key, std::uint32_t>> order(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) order[i] = {key_of({voxel}, points[i]), i};
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> first(points.size());
  for (std::size_t i = 0, run = 0; i < order.size(); ++i) {
    if (order[i].first != order[run].first) run = i;
    first[order[i].second] = order[run].second;
  }
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (first[i] == i) {
      result.voter_of_point[i] = static_cast<std::uint32_t>(result.voters.size());
      result.voters.push_back(i);
    } else {
      result.voter_of_point[i] = result.voter_of_point[first[i]];  // the first one comes before all others
    }
  }
  return result;
}

/// Voters sorted by cell, x fastest: the cells x - k .. x + k of a row are one run of voters.
struct SortedVoters {
  struct Cell {
    Key key;
    std::uint32_t begin;
    std::uint32_t end;
  };
  std::vector<std::uint32_t> source;  // index into voters
  std::vector<std::int32_t> x, y, z;  // with kLanes elements of room at the end
  std::vector<Cell> cells;
};
SortedVoters sort_by_cell(std::span<const StepPoint> points, std::span<const std::uint32_t> voters,
                          const Lattice& lattice) {
  std::vector<std::pair<Key, std::uint32_t>> order(voters.size());
  for (std::uint32_t i = 0; i < voters.size(); ++i) order[i] = {key_of(lattice, points[voters[i]]), i};
  std::sort(order.begin(), order.end());
  SortedVoters sorted;
  for (auto* v : {&sorted.x, &sorted.y, &sorted.z}) v->resize(voters.size() + kLanes);
  sorted.source.resize(voters.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const auto& [key, voter] = order[i];
    if (sorted.cells.empty() || sorted.cells.back().key != key) sorted.cells.push_back({key, i, i});
    ++sorted.cells.back().end;
    sorted.source[i] = voter;
    const StepPoint& p = points[voters[voter]];
    sorted.x[i] = p.x;
    sorted.y[i] = p.y;
    sorted.z[i] = p.z;
  }
  return sorted;
}

/// All votes for the voters of one cell.
void vote_for_cell(const SortedVoters& sorted, const SortedVoters::Cell& cell, int reach, const Decay& decay,
                   const VoteKernel& kernel, std::vector<VoteSums>& sums) {
  for (std::int64_t z = cell.key.z - reach; z <= cell.key.z + reach; ++z) {
    for (std::int64_t y = cell.key.y - reach; y <= cell.key.y + reach; ++y) {
      const auto before = [](const SortedVoters::Cell& c, const Key& key) { return c.key < key; };
      const auto first =
          std::lower_bound(sorted.cells.begin(), sorted.cells.end(), Key{z, y, cell.key.x - reach}, before);
      const auto last = std::lower_bound(first, sorted.cells.end(), Key{z, y, cell.key.x + reach + 1}, before);
      if (first == last) continue;
      const std::size_t begin = first->begin;
      const std::size_t count = std::prev(last)->end - begin;
      for (std::size_t i = cell.begin; i < cell.end; ++i) {
        kernel.gather(decay, {sorted.x[i], sorted.y[i], sorted.z[i]}, &sorted.x[begin], &sorted.y[begin],
                      &sorted.z[begin], count, sums[sorted.source[i]].value.data());
      }
    }
  }
}

}  // namespace

std::vector<VoteSums> vote_batch(std::span<const StepPoint> points, double step, const VotingParameters& parameters,
                                 int threads) {
  validate(parameters);
  constexpr int kReach = 2;  // cells of half the radius: the best of R, R/2, R/3 by count of tests
  const Thinning thinning = thin(points, std::llround(parameters.voxel / step));
  const Lattice lattice{std::max<std::int64_t>(1, std::llround(std::ceil(parameters.radius / step / kReach)))};
  const SortedVoters sorted = sort_by_cell(points, thinning.voters, lattice);
  const Decay decay = decay_in_steps(parameters.sigma, parameters.radius, step);
  const VoteKernel& kernel = vote_kernels()[0];

  std::vector<VoteSums> of_voters(thinning.voters.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    constexpr std::size_t kChunk = 16;
    for (std::size_t begin = next.fetch_add(kChunk); begin < sorted.cells.size(); begin = next.fetch_add(kChunk)) {
      for (std::size_t c = begin; c < std::min(begin + kChunk, sorted.cells.size()); ++c) {
        vote_for_cell(sorted, sorted.cells[c], kReach, decay, kernel, of_voters);
      }
    }
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back(work);
  work();
  helpers.clear();  // joins

  std::vector<VoteSums> sums(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sums[i] = of_voters[thinning.voter_of_point[i]];
  return sums;
}

StepCloud to_steps(std::span<const Eigen::Vector3d> points, double sigma) {
  StepCloud cloud;
  std::array<std::vector<double>, 3> coordinates;
  for (const Eigen::Vector3d& p : points) {
    if (!p.allFinite()) continue;
    for (int axis = 0; axis < 3; ++axis) coordinates[static_cast<std::size_t>(axis)].push_back(p[axis]);
  }
  cloud.not_finite = points.size() - coordinates[0].size();
  if (coordinates[0].empty()) return cloud;
  cloud.step = std::exp2(std::floor(std::log2(sigma)) - 16);
  Eigen::Vector3d origin;
  for (int axis = 0; axis < 3; ++axis) {
    auto& values = coordinates[static_cast<std::size_t>(axis)];
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    origin[axis] = *middle;
  }
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    const Eigen::Vector3d steps = (points[i] - origin) / cloud.step;
    if (!(steps.cwiseAbs().maxCoeff() < (1 << 30))) {
      ++cloud.too_far;
      continue;
    }
    const auto round = [&](int axis) { return static_cast<std::int32_t>(std::lround(steps[axis])); };
    cloud.points.push_back({round(0), round(1), round(2)});
    cloud.source.push_back(i);
  }
  return cloud;
}

CloudVotes vote_cloud(std::span<const Eigen::Vector3d> points, const VotingParameters& parameters, int threads) {
  validate(parameters);
  const StepCloud cloud = to_steps(points, parameters.sigma);
  CloudVotes votes;
  votes.tensors.resize(points.size());
  votes.not_finite = cloud.not_finite;
  votes.too_far = cloud.too_far;
  if (cloud.points.empty()) return votes;
  const std::vector<VoteSums> sums = vote_batch(cloud.points, cloud.step, parameters, threads);
  for (std::size_t i = 0; i < sums.size(); ++i) votes.tensors[cloud.source[i]] = to_tensor(sums[i], parameters.ball);
  return votes;
}

}  // namespace curbstone
