#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "services/tensor_voting/kernels/tensor.hpp"

namespace curbstone::tensor_voting::kernels {

/// A position in whole steps. The caller defines the length of a step (2 mm in the map). Differences of positions are
/// exact at any distance from the origin; they wrap, so a map may lie anywhere.
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

/// A block's recent sums can hold this many votes; then they must settle.
inline constexpr int kMaxRecent = 15;

/// b - a of coordinates, which may wrap.
[[nodiscard]] inline std::int32_t steps_between(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(b) - static_cast<std::uint32_t>(a));
}

/// Sixteen voters side by side, and the votes that they received recently. The voters lie within 2^13 steps of the
/// first one, and so must every point with which the block exchanges votes. An unused lane holds kFarAway, which is
/// too far away to give or to receive a vote. All data that an exchange accesses lies together.
struct alignas(64) VoterBlock {
  static constexpr std::int16_t kFarAway = 0x7fff;
  std::array<std::int16_t, kLanes> x;  ///< from the first voter
  std::array<std::int16_t, kLanes> y;
  std::array<std::int16_t, kLanes> z;
  StepPoint first;
  std::int32_t num_recent = 0;
  std::int32_t num_voters = 0;
  alignas(64) std::array<std::array<std::int32_t, kLanes>, VoteSums::kCount> recent{};

  /// Adds a voter; there must be a free lane. Returns its lane.
  std::size_t push_back(const StepPoint& at) {
    const auto lane = static_cast<std::size_t>(num_voters++);
    if (lane == 0) {
      first = at;
      x.fill(kFarAway);
      y.fill(0);
      z.fill(0);
    }
    x[lane] = static_cast<std::int16_t>(steps_between(first.x, at.x));
    y[lane] = static_cast<std::int16_t>(steps_between(first.y, at.y));
    z[lane] = static_cast<std::int16_t>(steps_between(first.z, at.z));
    return lane;
  }
  [[nodiscard]] StepPoint at(std::size_t lane) const {
    return {steps_between(-x[lane], first.x), steps_between(-y[lane], first.y), steps_between(-z[lane], first.z)};
  }
};

static_assert(sizeof(VoterBlock) == 512);

/// The votes that a block received earlier, in units of 2^kSettledBits, for which 32 bits suffice. The remainder below
/// one unit stays in the recent sums, which still have room for kMaxRecent votes.
struct alignas(64) SettledSums {
  std::array<std::array<std::int32_t, kLanes>, VoteSums::kCount> value{};
};
inline constexpr int kSettledBits = 24;
inline constexpr std::int32_t kLessThanSettled = (1 << kSettledBits) - 1;
static_assert(kMaxRecent * std::int64_t{1 << 27} + kLessThanSettled <= INT32_MAX);

[[nodiscard]] inline std::int64_t sum_of(std::int32_t settled, std::int32_t recent) {
  return (std::int64_t{settled} << kSettledBits) + recent;
}
[[nodiscard]] inline VoteSums sums_of(const VoterBlock& block, const SettledSums& settled, std::size_t lane) {
  VoteSums result;
  for (std::size_t c = 0; c < VoteSums::kCount; ++c)
    result.value[c] = sum_of(settled.value[c][lane], block.recent[c][lane]);
  return result;
}
/// Sets the sums of a lane that has received nothing.
inline void set_sums(const VoteSums& sums, VoterBlock& block, SettledSums& settled, std::size_t lane) {
  for (std::size_t c = 0; c < VoteSums::kCount; ++c) {
    settled.value[c][lane] = static_cast<std::int32_t>(sums.value[c] >> kSettledBits);
    block.recent[c][lane] = static_cast<std::int32_t>(sums.value[c]) & kLessThanSettled;
  }
}

inline constexpr std::size_t kTensorFloats = 7 * kLanes;
inline constexpr std::size_t kShapeFloats = 9 * kLanes;

/// A block that may hold voters within reach, and the number of votes given to it.
struct NearBlock {
  VoterBlock* block = nullptr;
  SettledSums* settled = nullptr;
  std::int64_t pairs = 0;
};

/// The inner loops, compiled once for each instruction set. All give the same bits: they use only float additions,
/// multiplications, divisions and roots, whose rounding IEEE 754 defines uniquely.
///
/// d^2 < radius2 is evaluated in float: exact while radius < 2^12 steps in each direction.
struct VoteKernel {
  const char* name;
  /// Votes between a voter at `at` and all voters in the blocks of `near`, in both directions: `sign` times the votes
  /// are added to the blocks and to `sums`. `sign` is 1, or -1 to take votes back. Adds the number of pairs to the
  /// blocks' `pairs` and returns their total.
  std::int64_t (*exchange)(const Decay& decay, const StepPoint& at, float sign, NearBlock* near, std::size_t num_near,
                           std::int64_t* sums);
  /// Decomposes blocks of kLanes tensors by Jacobi rotations. Input: kTensorFloats a block: xx, xy, xz, yy, yz, zz and
  /// one that is ignored, kLanes floats each. Output: kShapeFloats a block: normal and tangent (x, y, z), shares of
  /// stick, plate and ball. A tensor without votes gives the initial values of BasicDecomposition.
  void (*decompose)(const float* tensors, float* shapes, std::size_t blocks);
};

/// The kernels that this machine can run, fastest first.
[[nodiscard]] std::span<const VoteKernel> vote_kernels();

}  // namespace curbstone::tensor_voting::kernels
