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

inline constexpr int kLanes = 16;

/// A block's 32-bit sums hold the votes of so many others; then they must settle.
inline constexpr int kMaxRecent = 15;

/// Sixteen voters side by side, and the votes they have received: their sums are `sums` + `recent`. A lane in use for
/// nobody holds nowhere_near() of its neighbours: too far away to give or to receive a vote.
struct alignas(64) VoterBlock {
  std::array<std::int32_t, kLanes> x;
  std::array<std::int32_t, kLanes> y;
  std::array<std::int32_t, kLanes> z;
  std::array<std::array<std::int32_t, kLanes>, VoteSums::kCount> recent{};
  std::array<std::array<std::int64_t, kLanes>, VoteSums::kCount> sums{};
  std::int32_t num_recent = 0;

  [[nodiscard]] VoteSums sums_of(std::size_t lane) const {
    VoteSums result;
    for (std::size_t c = 0; c < VoteSums::kCount; ++c) result.value[c] = sums[c][lane] + recent[c][lane];
    return result;
  }
};
[[nodiscard]] inline std::int32_t nowhere_near(std::int32_t x) {
  return x ^ (1 << 30);
}

inline constexpr std::size_t kTensorFloats = 7 * kLanes;
inline constexpr std::size_t kShapeFloats = 9 * kLanes;

/// Blocks that lie side by side, and the pairs within reach found among them.
struct BlockRange {
  VoterBlock* blocks = nullptr;
  std::size_t count = 0;
  std::int64_t pairs = 0;
};

/// The inner loops, compiled once for each instruction set. All give the same bits: they add, multiply, divide and take
/// roots in float, which IEEE 754 rounds in one way only.
///
/// d^2 < radius2 is asked of a float: exact while radius < 2^12 steps in each direction.
struct VoteKernel {
  const char* name;
  /// Votes between a voter at `at` and each of the blocks of `ranges`, both ways: the blocks get `sign` (1, or -1 to
  /// take the votes back) times them, and so does `sums`. Sets the ranges' `pairs`.
  void (*exchange)(const Decay& decay, const StepPoint& at, float sign, BlockRange* ranges, std::size_t num_ranges,
                   std::int64_t* sums);
  /// Takes blocks of kLanes tensors apart, by Jacobi rotations. In: kTensorFloats a block, xx, xy, xz, yy, yz, zz and
  /// one that is not looked at, kLanes floats each. Out: kShapeFloats, normal and tangent (x, y, z), shares of stick,
  /// plate and ball. A tensor without votes gives what BasicDecomposition begins with.
  void (*decompose)(const float* tensors, float* shapes, std::size_t blocks);
};

/// The kernels that this machine can run, the fastest first.
[[nodiscard]] std::span<const VoteKernel> vote_kernels();

}  // namespace curbstone
