// The source of every vote kernel: compiled by vote_kernel_<isa>.cpp with that instruction set's flags, which define
// CURBSTONE_KERNEL. It must not call inline functions of other headers: the linker could keep the copy that was
// compiled for a machine that we are not on.

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include "services/tensor_voting/vote_kernel.hpp"

namespace curbstone {
namespace {

using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));
using Words = std::uint32_t __attribute__((vector_size(4 * kLanes)));
#ifdef __AVX512F__
using Longs = std::int64_t __attribute__((vector_size(8 * kLanes)));
#else
using Longs = std::int64_t __attribute__((vector_size(4 * kLanes)));  // half of the lanes
#endif

#define CURBSTONE_INLINE __attribute__((always_inline)) inline

template <class Vector>
CURBSTONE_INLINE Vector load(const void* from) {
  Vector v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}

/// e^x for x in [-80, 0], to 2e-7; for no others.
CURBSTONE_INLINE Floats exp_of(Floats x) {
  constexpr float kRounder = 12582912.0F;  // 1.5 * 2^23: adding and subtracting it rounds to a whole number
  const Floats n = (x * 1.44269504F + kRounder) - kRounder;
  const Floats r = (x - n * 0.693359375F) + n * 2.12194440e-4F;  // ln 2 in two parts; |r| <= ln 2 / 2
  // Taylor to r^7 / 7!
  Floats p = r * (1.0F / 5040) + 1.0F / 720;
  p = p * r + 1.0F / 120;
  p = p * r + 1.0F / 24;
  p = p * r + 1.0F / 6;
  p = p * r + 0.5F;
  p = p * r + 1.0F;
  p = p * r + 1.0F;
  const Ints exponent = (__builtin_convertvector(n, Ints) + 127) << 23;
  return p * __builtin_bit_cast(Floats, exponent);
}

struct Votes {
  Ints component[VoteSums::kCount];
};
struct Offsets {
  Floats x, y, z, squared;
};

/// Sums over the lanes of up to 2^33 votes.
struct LaneSums {
#ifdef __AVX512F__
  Longs all{};
  static CURBSTONE_INLINE LaneSums load_from(const std::int64_t* from) {
    return {load<Longs>(from)};
  }
  CURBSTONE_INLINE void store_to(std::int64_t* to) const {
    __builtin_memcpy(to, &all, sizeof all);
  }
  CURBSTONE_INLINE void add(Ints v) {  // __builtin_convertvector would go by two halves
    all += __builtin_bit_cast(Longs, _mm512_maskz_cvtepi32_epi64(0xff, __builtin_bit_cast(__m256i, v)));
  }
  [[nodiscard]] CURBSTONE_INLINE std::int64_t total() const {
    return (all[0] + all[4]) + (all[1] + all[5]) + ((all[2] + all[6]) + (all[3] + all[7]));
  }
#else
  Longs low{};
  Longs high{};
  static CURBSTONE_INLINE LaneSums load_from(const std::int64_t* from) {
    return {load<Longs>(from), load<Longs>(from + kLanes / 2)};
  }
  CURBSTONE_INLINE void store_to(std::int64_t* to) const {
    __builtin_memcpy(to, &low, sizeof low);
    __builtin_memcpy(to + kLanes / 2, &high, sizeof high);
  }
  CURBSTONE_INLINE void add(Ints v) {
    low += __builtin_convertvector(__builtin_shufflevector(v, v, 0, 1, 2, 3), Longs);
    high += __builtin_convertvector(__builtin_shufflevector(v, v, 4, 5, 6, 7), Longs);
  }
  [[nodiscard]] CURBSTONE_INLINE std::int64_t total() const {
    const Longs sum = low + high;
    return sum[0] + sum[1] + sum[2] + sum[3];
  }
#endif
};

CURBSTONE_INLINE bool any(Ints mask) {
#ifdef __AVX__
  using Quads = long long __attribute__((vector_size(32)));
  return !__builtin_ia32_ptestz256(__builtin_bit_cast(Quads, mask), __builtin_bit_cast(Quads, mask));
#else
  std::uint64_t halves[4];
  __builtin_memcpy(halves, &mask, sizeof mask);
  return ((halves[0] | halves[1]) | (halves[2] | halves[3])) != 0;
#endif
}

/// Wrapping differences of eight coordinates and one.
CURBSTONE_INLINE Floats minus(const std::int32_t* a, std::int32_t b) {
  const Words difference = load<Words>(a) - static_cast<std::uint32_t>(b);
  return __builtin_convertvector(__builtin_bit_cast(Ints, difference), Floats);
}

CURBSTONE_INLINE Offsets offsets_from(const StepPoint& at, const std::int32_t* x, const std::int32_t* y,
                                      const std::int32_t* z) {
  const Floats dx = minus(x, at.x);
  const Floats dy = minus(y, at.y);
  const Floats dz = minus(z, at.z);
  return {dx, dy, dz, dx * dx + dy * dy + dz * dz};
}

CURBSTONE_INLINE Ints within_reach(const Decay& decay, const Offsets& d) {
  return (d.squared > 0.0F) & (d.squared < decay.radius2);
}

/// The votes between a votee and the voters at offsets `d` in the lanes of `mask`. Neither end can tell which one it
/// is: the offset enters by products of two of its components only.
CURBSTONE_INLINE Votes votes_at(const Decay& decay, float sign, const Offsets& d, Ints mask) {
  const Floats squared = mask ? d.squared : Floats{} + 1.0F;
  const Floats x = squared * -decay.inverse_sigma2;
  Floats w = exp_of(x > -80.0F ? x : Floats{} - 80.0F) * (sign * static_cast<float>(1 << 30));
  w = mask ? w : Floats{};
  const Floats g = w / squared;
  const Floats gx = g * d.x;
  const Floats gy = g * d.y;
  Votes votes;
  votes.component[VoteSums::kMass] = __builtin_convertvector(w, Ints);
  votes.component[VoteSums::kXX] = __builtin_convertvector(gx * d.x, Ints);
  votes.component[VoteSums::kXY] = __builtin_convertvector(gx * d.y, Ints);
  votes.component[VoteSums::kXZ] = __builtin_convertvector(gx * d.z, Ints);
  votes.component[VoteSums::kYY] = __builtin_convertvector(gy * d.y, Ints);
  votes.component[VoteSums::kYZ] = __builtin_convertvector(gy * d.z, Ints);
  return votes;
}

/// Lanes that are 1, of lanes that are 0 or 1.
CURBSTONE_INLINE std::int64_t number_of(Ints pairs) {
#ifdef __AVX__
  return __builtin_popcount(static_cast<unsigned>(__builtin_ia32_movmskps256(__builtin_bit_cast(Floats, pairs << 31))));
#else
  std::int64_t sum = 0;
  for (int lane = 0; lane < kLanes; ++lane) sum += pairs[lane];
  return sum;
#endif
}

/// The votes between one voter and a block, both ways. Returns the number of pairs.
CURBSTONE_INLINE std::int64_t exchange_block(const Decay& decay, const StepPoint& at, float sign, VoterBlock* block,
                                             LaneSums* own) {
  const auto* const x = reinterpret_cast<const std::int32_t*>(block);
  const Offsets offsets = offsets_from(at, x, x + kLanes, x + 2 * kLanes);
  const Ints mask = within_reach(decay, offsets);
  if (!any(mask)) return 0;
  const Votes votes = votes_at(decay, sign, offsets, mask);
#pragma GCC unroll 6
  for (int c = 0; c < VoteSums::kCount; ++c) {
    own[c].add(votes.component[c]);
    auto* const received = reinterpret_cast<std::int64_t*>(&block->sums) + c * kLanes;
    LaneSums theirs = LaneSums::load_from(received);
    theirs.add(votes.component[c]);
    theirs.store_to(received);
  }
  return number_of(-mask);
}

void exchange(const Decay& decay, const StepPoint& at, float sign, BlockRange* ranges, std::size_t num_ranges,
              std::int64_t* sums) {
  LaneSums own[VoteSums::kCount];
  for (BlockRange* range = ranges; range != ranges + num_ranges; ++range) {
    range->pairs = 0;
    for (VoterBlock* block = range->blocks; block != range->blocks + range->count; ++block) {
      range->pairs += exchange_block(decay, at, sign, block, own);
    }
  }
#pragma GCC unroll 6
  for (int c = 0; c < VoteSums::kCount; ++c) sums[c] += own[c].total();
}

std::int64_t gather(const Decay& decay, const StepPoint& at, const std::int32_t* x, const std::int32_t* y,
                    const std::int32_t* z, std::size_t count, std::int64_t* sums) {
  constexpr Ints kLane = {0, 1, 2, 3, 4, 5, 6, 7};
  LaneSums own[VoteSums::kCount];
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Offsets offsets = offsets_from(at, x + i, y + i, z + i);
    const auto remaining = static_cast<std::int32_t>(count - i < kLanes ? count - i : kLanes);
    const Ints mask = within_reach(decay, offsets) & (kLane < remaining);
    if (!any(mask)) continue;
    pairs += number_of(-mask);
    const Votes votes = votes_at(decay, 1.0F, offsets, mask);
#pragma GCC unroll 6
    for (int c = 0; c < VoteSums::kCount; ++c) own[c].add(votes.component[c]);
  }
#pragma GCC unroll 6
  for (int c = 0; c < VoteSums::kCount; ++c) sums[c] += own[c].total();
  return pairs;
}

}  // namespace

extern const VoteKernel CURBSTONE_KERNEL;
const VoteKernel CURBSTONE_KERNEL = {CURBSTONE_KERNEL_NAME, exchange, gather};

}  // namespace curbstone
