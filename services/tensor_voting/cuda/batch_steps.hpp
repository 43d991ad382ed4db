#pragma once

#include <cstdint>

#include "services/tensor_voting/cuda/batch_votes.hpp"
#include "services/tensor_voting/cuda/cell_grid.hpp"
#include "services/tensor_voting/cuda/warp_gather.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"

namespace curbstone::tensor_voting::cuda {

/// @file
/// The steps of batch voting, each a function of the index of a point, a voter or a window of 32 voters.

/// Special keys in place of a cell or voxel: the reason why a point has none. They sort behind all other keys.
inline constexpr std::uint64_t kThinnedOut = CellGrid::kNoCell;
inline constexpr std::uint64_t kTooFar = CellGrid::kNoCell + 1;
inline constexpr std::uint64_t kNotFinite = CellGrid::kNoCell + 2;

/// Conversion of metres to steps, and of steps to voxels.
struct CloudFrame {
  double origin[3] = {0, 0, 0};           ///< m
  double steps_per_metre = 1;             ///< a power of two
  double voxels_per_step = 0;             ///< 0: no thinning
  double origin_in_voxel[3] = {0, 0, 0};  ///< position of the origin inside its voxel, in voxels
};

struct PlacePoints {
  const double* xyz;  ///< m
  CloudFrame frame;
  CellGrid grid;
  kernels::StepPoint* points;  ///< they wrap: only differences below 2^31 are used
  std::uint32_t* order;        ///< 0, 1, 2, ... to be sorted with the keys
  std::uint64_t* cells;        ///< key
  std::uint64_t* voxels;       ///< key; nullptr without thinning
  std::uint32_t* voter_of;     ///< the point itself, or kNoVoter

  static constexpr std::uint32_t kNoVoter = 0xffffffff;
  static constexpr double kFar = 549755813888.0;  ///< steps: 2^39

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    const double* const p = xyz + 3 * std::uint64_t{i};
    std::int64_t steps[3] = {0, 0, 0};
    std::uint64_t problem = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double s = (p[axis] - frame.origin[axis]) * frame.steps_per_metre;
      if (!(p[axis] - p[axis] == 0)) {
        problem = kNotFinite;
      } else if (!(s < kFar && s > -kFar)) {
        problem = larger(problem, kTooFar);
      } else {
        steps[axis] = static_cast<std::int64_t>(::floor(s + 0.5));
      }
    }
    const auto wrapped = [&steps](int axis) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(steps[axis]));
    };
    points[i] = {wrapped(0), wrapped(1), wrapped(2)};
    order[i] = i;
    cells[i] = problem != 0 ? problem : grid.key(steps[0], steps[1], steps[2]);
    voter_of[i] = problem != 0 ? kNoVoter : i;
    if (voxels != nullptr) voxels[i] = problem != 0 ? problem : voxel_of(steps);
  }

  /// Adds half a step, so that rounding of the product cannot move a coordinate on the lattice below it.
  CURBSTONE_HD std::uint64_t voxel_of(const std::int64_t* steps) const {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double v = (static_cast<double>(steps[axis]) + 0.5) * frame.voxels_per_step + frame.origin_in_voxel[axis];
      key = key << 21 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(::floor(v))) & 0x1fffff);
    }
    return key;
  }
};

/// For points sorted by voxel: the first point of the cloud in each voxel votes for all of them.
struct ThinOut {
  const std::uint64_t* voxels;  ///< sorted; of equal ones the earlier point comes first
  const std::uint32_t* order;   ///< point at each sorted position
  std::uint32_t num_points;
  std::uint64_t* cells;     ///< of points, not sorted
  std::uint32_t* voter_of;  ///< of points

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    if (voxels[i] >= CellGrid::kNoCell) return;
    const std::uint32_t point = order[i];
    const std::uint32_t first = order[lower_bound(voxels, 0, num_points, voxels[i])];
    voter_of[point] = first;
    if (first != point) cells[point] = kThinnedOut;
  }
};

/// Counts the points of the sorted cells that vote, that are not finite, and that are too far.
struct CountKinds {
  const std::uint64_t* cells;
  std::uint32_t num_points;
  std::uint32_t* counts;

  CURBSTONE_HD void operator()(std::uint32_t) const {
    const auto before = [this](std::uint64_t key) { return lower_bound(cells, 0, num_points, key); };
    counts[0] = before(kThinnedOut);
    counts[1] = num_points - before(kNotFinite);
    counts[2] = before(kNotFinite) - before(kTooFar);
  }
};

/// Puts the voters in the order of their cells.
struct OrderVoters {
  const kernels::StepPoint* points;
  const std::uint32_t* order;
  kernels::StepPoint* voters;
  std::uint32_t* rank;  ///< of a point among the voters

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    voters[i] = points[order[i]];
    rank[order[i]] = i;
  }
};

/// Gives every point the tensor of its voter; skipped points get a tensor without votes.
struct ScatterResults {
  const std::uint32_t* voter_of;
  const std::uint32_t* rank;
  const kernels::TensorF* of_voters;
  const VotedShape* shapes_of_voters;
  kernels::TensorF* tensors;
  VotedShape* shapes;

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    const std::uint32_t voter = voter_of[i];
    tensors[i] = voter == PlacePoints::kNoVoter ? kernels::TensorF{} : of_voters[rank[voter]];
    shapes[i] = voter == PlacePoints::kNoVoter ? VotedShape{} : shapes_of_voters[rank[voter]];
  }
};

/// Windows of votees gather votes from the voters around them, each window in kParts parts. The last parts run first:
/// most of them have nothing to do, and some have much.
template <class Votes>
struct GatherWindow {
  using Memory = GatherMemory<typename Votes::Voter>;
  CellGrid grid;
  SortedKeys votees;
  SortedKeys voters;
  Votes votes;

  template <class Warp>
  CURBSTONE_HD void operator()(Warp& warp, Memory& memory, std::uint32_t i) const {
    const std::uint32_t windows = num_windows(votees.size);
    WarpGather<Warp, Votes>(warp, memory, grid, votees, voters, votes).run(i % windows, kParts - 1 - i / windows);
  }
};

/// Counts the pairs that each window would test.
struct CountTests {
  using Memory = GatherMemory<CountVotes::Voter>;
  CellGrid grid;
  SortedKeys voters;
  std::uint64_t* tests;

  template <class Warp>
  CURBSTONE_HD void operator()(Warp& warp, Memory& memory, std::uint32_t window) const {
    const CountVotes none{};
    const std::uint64_t count =
        WarpGather<Warp, CountVotes>(warp, memory, grid, voters, voters, none).count_tests(window);
    warp.each([&](std::uint32_t lane) {
      if (lane == 0) tests[window] = count;
    });
  }
};

}  // namespace curbstone::tensor_voting::cuda
