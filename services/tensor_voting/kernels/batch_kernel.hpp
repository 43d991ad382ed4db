#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace curbstone::tensor_voting::kernels {

/// @file
/// The inner loops of batch voting, compiled once for each instruction set. Eight neighbouring votees occupy the lanes,
/// and each nearby voter is processed for all of them at once; with sixteen lanes, two voters at a time. A larger block
/// would be less efficient: more voters would be near some of its votees and out of reach of the others.
///
/// In float with fused multiply-add: exact to 3e-6 of a tensor's norm. The result does not depend on the number of
/// threads. Unlike VotingField's, its bits may differ between machines.

inline constexpr int kBlock = 8;
inline constexpr int kReadAhead = 16;

/// An oriented voter (second pass): e1, e3 and its stick and plate saliency.
struct OrientedVoter {
  float normal[3];
  float stick;
  float tangent[3];
  float plate;
};

/// Voters in the order of their cells. The arrays are readable for kReadAhead elements past their end.
struct VoterArrays {
  const std::int32_t* x;  ///< in steps, modulo 2^32: only differences count
  const std::int32_t* y;
  const std::int32_t* z;
  const float* weight;            ///< nullptr: all 1
  const OrientedVoter* oriented;  ///< for the second pass only
};
/// Voters begin .. begin + count - 1.
struct VoterRun {
  std::uint32_t begin;
  std::uint32_t count;
};

/// Lengths in units of 2^20 steps: whole steps within 16 units are exact in float.
struct BatchScale {
  float decay;   ///< 1 / sigma^2
  float radius;  ///< the cut-off
};

/// Sums of the votes for each votee of a block, component after component: mass, xx, xy, xz, yy, yz, zz.
struct BlockVotes {
  float sum[7 * kBlock];
};

struct BatchKernel {
  const char* name;
  /// Ball votes of the voters in `runs` for votees first .. first + count - 1, count <= kBlock: sums of w and of w u
  /// u^T (six components). A voter at the votee's own place does not vote.
  void (*ball)(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
               std::uint32_t count, const BatchScale& scale, float* votes);
  /// The stick and plate votes of decomposed voters, formula (G): the sums are the tensors themselves.
  void (*oriented)(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
                   std::uint32_t count, const BatchScale& scale, float* votes);
  /// The sum of the weights of the voters within the radius, including the votee's own: one component.
  void (*count)(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
                std::uint32_t count, const BatchScale& scale, float* votes);
};

/// The kernels that this machine can run, fastest first.
[[nodiscard]] std::span<const BatchKernel> batch_kernels();

}  // namespace curbstone::tensor_voting::kernels
