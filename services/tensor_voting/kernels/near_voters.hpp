// Part of every batch kernel's source (batch_kernel_impl.hpp): finds the voters near a block of votees.
#pragma once

#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/kernels/lanes.hpp"

namespace curbstone::tensor_voting::kernels {
namespace {

constexpr float kStepsPerUnit = 1 << 20;

/// Several neighbouring votees, in steps from their middle. Unused lanes repeat the first votee; their sums are
/// ignored.
struct Votees {
  float x[kBlock];
  float y[kBlock];
  float z[kBlock];
  std::int32_t middle[3];
  float extent;  // maximum distance of a votee from the middle
};

Votees votees_of(const VoterArrays& voters, std::uint32_t first, std::uint32_t count) {
  const std::int32_t* const axes[3] = {voters.x + first, voters.y + first, voters.z + first};
  Votees votees;
  float* const out[3] = {votees.x, votees.y, votees.z};
  for (int axis = 0; axis < 3; ++axis) {
    const auto from_first = [&](std::uint32_t i) {  // coordinates wrap, differences do not
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(axes[axis][i]) -
                                       static_cast<std::uint32_t>(axes[axis][0]));
    };
    std::int32_t low = 0;
    std::int32_t high = 0;
    for (std::uint32_t i = 1; i < count; ++i) {
      low = from_first(i) < low ? from_first(i) : low;
      high = from_first(i) > high ? from_first(i) : high;
    }
    const std::int32_t middle = low + (high - low) / 2;
    votees.middle[axis] =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(axes[axis][0]) + static_cast<std::uint32_t>(middle));
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      out[axis][i] = static_cast<float>(from_first(i < count ? i : 0) - middle);
    }
  }
  float extent2 = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float d2 = votees.x[i] * votees.x[i] + votees.y[i] * votees.y[i] + votees.z[i] * votees.z[i];
    extent2 = d2 > extent2 ? d2 : extent2;
  }
  votees.extent = __builtin_sqrtf(extent2);
  return votees;
}

/// The voters that can reach a block of votees, in steps from the block's middle.
struct NearVoters {
  static constexpr std::size_t kCapacity = 1024;
  std::size_t size = 0;
  float x[kCapacity + kWidth];
  float y[kCapacity + kWidth];
  float z[kCapacity + kWidth];
  std::uint32_t index[kCapacity + kWidth];

  /// Takes voters from the front of `run` until the run or the free space is used up.
  template <bool indexed>
  CURBSTONE_INLINE void collect(const VoterArrays& voters, VoterRun& run, const Votees& votees, float reach) {
    constexpr auto kStep = static_cast<std::uint32_t>(kWidth);
    Ints lane;
    for (int i = 0; i < kWidth; ++i) lane[i] = i;
    const std::int32_t middle[3] = {votees.middle[0], votees.middle[1], votees.middle[2]};
    std::size_t end = size;  // in a register: each step depends on the one before
    std::uint32_t next = run.begin;
    const std::uint32_t last = run.begin + run.count;
    for (; next < last && end <= kCapacity - kStep; next += kStep) {
      const Floats px = difference(load<Ints>(voters.x + next), middle[0]);
      const Floats py = difference(load<Ints>(voters.y + next), middle[1]);
      const Floats pz = difference(load<Ints>(voters.z + next), middle[2]);
      Mask near = below(px * px + py * py + pz * pz, all(reach * reach));
      if (last - next < kStep) {
        near = below(near, __builtin_convertvector(lane, Floats), all(static_cast<float>(last - next)));
      }
      store_packed(x + end, near, px);
      store_packed(y + end, near, py);
      store_packed(z + end, near, pz);
      if constexpr (indexed) store_packed(index + end, near, lane + static_cast<std::int32_t>(next));
      end += static_cast<unsigned>(__builtin_popcount(bits(near)));
    }
    size = end;
    run = {next, next < last ? last - next : 0};
  }
  /// Pads the number of voters to a multiple of `of` with voters at (far, 0, 0).
  CURBSTONE_INLINE void pad(std::size_t of, float far) {
    for (; size % of != 0; ++size) x[size] = far, y[size] = z[size] = 0, index[size] = 0;
  }
};

}  // namespace
}  // namespace curbstone::tensor_voting::kernels
