#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "services/tensor_voting/tensor.hpp"

namespace curbstone {

/// A position in whole steps. What a step is, is the caller's affair (2 mm in the map). Differences of positions are
/// exact, however far from the origin they are; they wrap, so that a map may lie anywhere.
struct StepPoint {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
  bool operator==(const StepPoint&) const = default;
};

/// The decay in steps: w = exp(-d^2 inverse_sigma2) for 0 < d^2 < radius2.
struct Decay {
  float inverse_sigma2 = 0;
  float radius2 = 0;
};
[[nodiscard]] inline Decay decay_in_steps(double sigma, double radius, double step) {
  return {static_cast<float>(step * step / (sigma * sigma)), static_cast<float>(radius * radius / (step * step))};
}

inline constexpr int kLanes = 8;

/// Eight voters side by side, and the votes they have received. A lane in use for nobody holds nowhere_near() of its
/// neighbours: too far away to give or to receive a vote.
struct alignas(32) VoterBlock {
  std::array<std::int32_t, kLanes> x;
  std::array<std::int32_t, kLanes> y;
  std::array<std::int32_t, kLanes> z;
  std::array<std::array<std::int64_t, kLanes>, VoteSums::kCount> sums;
};
[[nodiscard]] inline std::int32_t nowhere_near(std::int32_t x) {
  return x ^ (1 << 30);
}

/// Blocks that lie side by side, and the pairs within reach found among them.
struct BlockRange {
  VoterBlock* blocks = nullptr;
  std::size_t count = 0;
  std::int64_t pairs = 0;
};

/// The inner loops, compiled once for each instruction set. All give the same bits: a vote is evaluated in float by
/// additions, multiplications and divisions that IEEE 754 rounds in one way only, then cut to the integers of VoteSums.
///
/// d^2 < radius2 is asked of a float: exact while radius < 2^12 steps in each direction.
struct VoteKernel {
  const char* name;
  /// Votes between a voter at `at` and each of the blocks of `ranges`, both ways: the blocks' sums get `sign` (1, or -1
  /// to take the votes back) times them, and so do `sums`. Sets the ranges' `pairs`.
  void (*exchange)(const Decay& decay, const StepPoint& at, float sign, BlockRange* ranges, std::size_t num_ranges,
                   std::int64_t* sums);
  /// Votes of `count` voters for a votee at `at`. The arrays must be readable for kLanes elements past their end.
  std::int64_t (*gather)(const Decay& decay, const StepPoint& at, const std::int32_t* x, const std::int32_t* y,
                         const std::int32_t* z, std::size_t count, std::int64_t* sums);
};

/// The kernels that this machine can run, the fastest first.
[[nodiscard]] std::span<const VoteKernel> vote_kernels();

}  // namespace curbstone
