#pragma once

#include <cstdint>

#include "services/tensor_voting/cuda/batch_votes.hpp"
#include "services/tensor_voting/cuda/host_device.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"

namespace curbstone::tensor_voting::cuda {

/// A voter of the growing map, as stored on the device.
struct ResidentVoter {
  kernels::StepPoint at;
  std::uint32_t tile = 0;    ///< slot
  std::uint32_t number = 0;  ///< in its tile
};
/// Votes received by a voter: VoteSums, and the number of votes.
struct ResidentSums {
  std::int64_t value[kernels::VoteSums::kCount];
  std::int64_t votes;
};

/// The votes of one pair in whole units, operation for operation as in the CPU's exact kernels (vote_kernel_impl.hpp):
/// both give the same bits.
struct ExactPair {
  std::int32_t component[kernels::VoteSums::kCount];

  CURBSTONE_HD ExactPair(const kernels::Decay& decay, float sign, const LocalOffset& d, float d2) {
    constexpr float kLog2E = 1.44269504F;
    const float y = d2 * (-decay.inverse_sigma2 * kLog2E);
    const float w = power_of_two(y < -126.0F ? -126.0F : y) * (sign * kernels::kUnitsPerVote);
    const float g = w / d2;
    const float gx = g * d.x;
    const float gy = g * d.y;
    component[kernels::VoteSums::kMass] = rounded(w);
    component[kernels::VoteSums::kXX] = rounded(gx * d.x);
    component[kernels::VoteSums::kXY] = rounded(gx * d.y);
    component[kernels::VoteSums::kXZ] = rounded(gx * d.z);
    component[kernels::VoteSums::kYY] = rounded(gy * d.y);
    component[kernels::VoteSums::kYZ] = rounded(gy * d.z);
  }

  /// 2^y for y in [-126, 0]: 2^n times the Taylor polynomial of e^f, |f| <= ln 2 / 2; to 3e-7.
  CURBSTONE_HD static float power_of_two(float y) {
    constexpr float kRounder = 12582912.0F;  // 1.5 * 2^23: adding it leaves the nearest whole number in the low bits
    const float shifted = y + kRounder;
    const float f = (y - (shifted - kRounder)) * 0.693147181F;
    float p = f * (1.0F / 720) + 1.0F / 120;
    p = p * f + 1.0F / 24;
    p = p * f + 1.0F / 6;
    p = p * f + 0.5F;
    p = p * f + 1.0F;
    p = p * f + 1.0F;
    const auto exponent = static_cast<std::int32_t>(static_cast<std::uint32_t>(bits_of_float(shifted)) << 23);
    return float_of_bits(bits_of_float(p) + exponent);
  }
};

/// Votees gather exact votes from some of the voters, or return them (sign -1).
struct ExactVotes {
  struct alignas(16) Voter {
    LocalOffset at;
    float unused;
  };
  using Votee = LocalOffset;
  struct Sums {
    std::int64_t value[kernels::VoteSums::kCount] = {};
    std::int64_t votes = 0;
  };

  kernels::Decay decay;
  float sign = 1;
  const ResidentVoter* votees = nullptr;
  const ResidentVoter* voters = nullptr;
  ResidentSums* received = nullptr;  ///< of the votees
  std::uint8_t* changed = nullptr;   ///< by tile slot: 1 if one of its votees has received a vote

  CURBSTONE_HD kernels::StepPoint position(std::uint32_t i) const { return votees[i].at; }
  CURBSTONE_HD Votee votee(std::uint32_t i, const kernels::StepPoint& origin) const {
    return offset_from(origin, votees[i].at);
  }
  CURBSTONE_HD Voter voter(std::uint32_t i, const kernels::StepPoint& origin) const {
    return {offset_from(origin, voters[i].at), 0.0F};
  }
  CURBSTONE_HD void add(const Voter& voter, const Votee& votee, Sums& sums) const {
    const LocalOffset d = {voter.at.x - votee.x, voter.at.y - votee.y, voter.at.z - votee.z};
    const float d2 = d.x * d.x + d.y * d.y + d.z * d.z;
    if (!(d2 > 0 && d2 < decay.radius2)) return;
    const ExactPair pair(decay, sign, d, d2);
    for (int c = 0; c < kernels::VoteSums::kCount; ++c) sums.value[c] += pair.component[c];
    ++sums.votes;
  }
  /// No other thread writes these sums. All threads that change a tile write the same 1.
  CURBSTONE_HD void store(std::uint32_t i, const Sums& sums) const {
    if (sums.votes == 0) return;
    ResidentSums& to = received[i];
    for (int c = 0; c < kernels::VoteSums::kCount; ++c) to.value[c] += sums.value[c];
    to.votes += sign > 0 ? sums.votes : -sums.votes;
    changed[votees[i].tile] = 1;
  }
};

}  // namespace curbstone::tensor_voting::cuda
