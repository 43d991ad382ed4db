#pragma once

#include <cstdint>

#include "services/tensor_voting/cuda/cell_grid.hpp"
#include "services/tensor_voting/cuda/host_device.hpp"

namespace curbstone::tensor_voting::cuda {

inline constexpr std::uint32_t kWarp = 32;

/// Points in the order of their keys.
struct SortedKeys {
  const std::uint64_t* keys = nullptr;
  std::uint32_t size = 0;
};
inline constexpr std::uint32_t kParts = 8;  // warps that share a window
[[nodiscard]] CURBSTONE_HD inline std::uint32_t num_windows(std::uint32_t size) {
  return (size + kWarp - 1) / kWarp;
}

/// Shared memory of a warp: a tile of voters, and the position of each row of voters in the sorted order.
template <class Voter>
struct GatherMemory {
  static constexpr std::uint32_t kTile = sizeof(Voter) > 16 ? 64 : 128;
  Voter voters[kTile];
  // Lengths are summed in groups of four: nvcc's code loads a little beyond their end. The bytes there must not be
  // written at the same time.
  std::uint32_t length[CellGrid::kRows];
  std::uint32_t begin[CellGrid::kRows];
  std::uint32_t offset[CellGrid::kRows + 1];  // start of each row in the concatenation of all rows' voters

  /// The index of the k-th of all voters.
  CURBSTONE_HD std::uint32_t index_of(std::uint32_t k) const {
    int row = 0;
    for (int step = 32; step > 0; step /= 2) {
      if (row + step < CellGrid::kRows && offset[row + step] <= k) row += step;
    }
    return begin[row] + (k - offset[row]);
  }
};

/// The inner loop of all voting on the device. A warp handles 32 votees, neighbours in the sorted order, one to a
/// thread. Every voter near them is loaded into shared memory once and read by all threads. Sums stay in registers, no
/// thread writes another thread's results, and votes are summed in the sorted order.
///
/// `Warp` runs `each(f)` for its 32 lanes, with Lanes<T> a T for each; sync() separates the writes of lanes from the
/// reads of others. A device's warp runs the lanes in parallel, the host runs them one after the other. `Votes` has
///   Voter, Votee, Sums                the data kept of each
///   position(i)                       of votee i, in steps
///   votee(i, origin), voter(i, origin)  relative to a nearby position, where floats are exact
///   add(voter, votee, sums)
///   store(i, sums)                    after the last add()
template <class Warp, class Votes>
class WarpGather {
 public:
  using Memory = GatherMemory<typename Votes::Voter>;

  CURBSTONE_HD WarpGather(Warp& warp, Memory& memory, const CellGrid& grid, const SortedKeys& votees,
                          const SortedKeys& voters, const Votes& votes)
      : warp_(warp), memory_(memory), grid_(grid), votees_(votees), voters_(voters), votes_(votes) {}

  /// Handles the stretches of votees 32 window .. 32 window + 31 that belong to `part`. Each stretch searches its
  /// voters anew. Sparse points form one stretch each, which would occupy one warp long after all others have finished:
  /// kParts warps share them.
  CURBSTONE_HD void run(std::uint32_t window, std::uint32_t part) {
    const std::uint32_t begin = window * kWarp;
    const std::uint32_t end = smaller(begin + kWarp, votees_.size);
    std::uint32_t turn = 0;
    for (std::uint32_t first = begin; first < end;) {
      const std::uint32_t last = end_of_stretch(first, end);
      if (turn == part) gather(begin, first, last);
      turn = (turn + 1) % kParts;
      first = last;
    }
  }

  /// The number of pairs that run() tests, for all parts of the window together.
  CURBSTONE_HD std::uint64_t count_tests(std::uint32_t window) {
    const std::uint32_t begin = window * kWarp;
    const std::uint32_t end = smaller(begin + kWarp, votees_.size);
    std::uint64_t tests = 0;
    for (std::uint32_t first = begin; first < end;) {
      const std::uint32_t last = end_of_stretch(first, end);
      tests += std::uint64_t{find_voters(first, last)} * (last - first);
      first = last;
    }
    return tests;
  }

 private:
  /// Votees first .. last - 1 are one stretch; lane 0 corresponds to votee `begin`.
  CURBSTONE_HD void gather(std::uint32_t begin, std::uint32_t first, std::uint32_t last) {
    typename Warp::template Lanes<typename Votes::Sums> sums{};
    typename Warp::template Lanes<typename Votes::Votee> votee{};
    const auto is_in = [&](std::uint32_t lane) { return begin + lane >= first && begin + lane < last; };
    const auto origin = votes_.position(first);
    const std::uint32_t count = find_voters(first, last);
    warp_.each([&](std::uint32_t lane) {
      if (is_in(lane)) votee[lane] = votes_.votee(begin + lane, origin);
    });
    for (std::uint32_t done = 0; done < count; done += Memory::kTile) {
      const std::uint32_t staged = smaller(Memory::kTile, count - done);
      warp_.each([&](std::uint32_t lane) {
        for (std::uint32_t k = lane; k < staged; k += kWarp) {
          memory_.voters[k] = votes_.voter(memory_.index_of(done + k), origin);
        }
      });
      warp_.sync();
      warp_.each([&](std::uint32_t lane) {
        if (!is_in(lane)) return;
        for (std::uint32_t k = 0; k < staged; ++k) votes_.add(memory_.voters[k], votee[lane], sums[lane]);
      });
      warp_.sync();
    }
    warp_.each([&](std::uint32_t lane) {
      if (is_in(lane)) votes_.store(begin + lane, sums[lane]);
    });
  }

  /// The end of the votees that can share their voters with `first`: in the same row, and not too long a stretch of it.
  CURBSTONE_HD std::uint32_t end_of_stretch(std::uint32_t first, std::uint32_t end) const {
    return lower_bound(votees_.keys, first, end, CellGrid::end_of_stretch(votees_.keys[first]) + 1);
  }

  /// Finds the voters around votees first .. last - 1: one row to a lane. Returns their number.
  CURBSTONE_HD std::uint32_t find_voters(std::uint32_t first, std::uint32_t last) {
    const std::uint64_t low = votees_.keys[first];
    const std::uint64_t high = votees_.keys[last - 1];
    warp_.each([&](std::uint32_t lane) {
      for (std::uint32_t row = lane; row < CellGrid::kRows; row += kWarp) {
        const CellGrid::KeyRange range = grid_.voters_in_row(low, high, static_cast<int>(row));
        const std::uint32_t begin = lower_bound(voters_.keys, 0, voters_.size, range.low);
        memory_.begin[row] = begin;
        memory_.length[row] = lower_bound(voters_.keys, begin, voters_.size, range.high) - begin;
      }
    });
    warp_.sync();
    warp_.each([&](std::uint32_t lane) {
      for (std::uint32_t row = lane; row <= CellGrid::kRows; row += kWarp) {
        std::uint32_t sum = 0;
        for (std::uint32_t r = 0; r < row; ++r) sum += memory_.length[r];
        memory_.offset[row] = sum;
      }
    });
    warp_.sync();
    return memory_.offset[CellGrid::kRows];
  }

  Warp& warp_;
  Memory& memory_;
  const CellGrid& grid_;
  const SortedKeys& votees_;
  const SortedKeys& voters_;
  const Votes& votes_;
};

}  // namespace curbstone::tensor_voting::cuda
