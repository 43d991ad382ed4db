// The source of every vote kernel: compiled by vote_kernel_<isa>.cpp with that instruction set's flags, which define
// CURBSTONE_KERNEL. It must not call inline functions of other headers: the linker could keep the copy that was
// compiled for another machine. Additions, multiplications, divisions and roots are written out one by one, and nothing
// may fuse them (-ffp-contract=off), so that the bits are the same everywhere.

#include "services/tensor_voting/kernels/lanes.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"

namespace curbstone::tensor_voting::kernels {
namespace {

/// e^(-x) in terms of y = -x / ln 2, for y in [-126, 0]: 2^n times a polynomial on [-1/2, 1/2]; to 3e-7.
CURBSTONE_INLINE Floats power_of_two(Floats y) {
  constexpr float kRounder = 12582912.0F;  // 1.5 * 2^23: adding it leaves the nearest whole number in the low bits
  const Floats shifted = y + kRounder;
  const Floats f = (y - (shifted - kRounder)) * 0.693147181F;
  // Taylor to f^6 / 6!; |f| <= ln 2 / 2
  Floats p = f * (1.0F / 720) + 1.0F / 120;
  p = p * f + 1.0F / 24;
  p = p * f + 1.0F / 6;
  p = p * f + 0.5F;
  p = p * f + 1.0F;
  p = p * f + 1.0F;
  const Ints exponent = __builtin_bit_cast(Ints, shifted) << 23;
  return __builtin_bit_cast(Floats, __builtin_bit_cast(Ints, p) + exponent);
}

struct Offsets {
  Floats x, y, z, squared;
};

struct Votes {
  Ints component[VoteSums::kCount];
};

/// The weights of votes at some distances, in units. Lanes out of reach have weight 0 and distance 1.
struct Weights {
  Floats squared;
  Floats w;
};
CURBSTONE_INLINE Weights weights_at(const Decay& decay, float sign, const Offsets& d, Mask mask) {
  constexpr float kLog2E = 1.44269504F;
  const Floats squared = choose(mask, d.squared, all(1));
  const Floats y = squared * (-decay.inverse_sigma2 * kLog2E);
  return {squared, keep(mask, power_of_two(choose(below(all(-126), y), y, all(-126))) * (sign * kUnitsPerVote))};
}

/// The votes between two points at offsets `d`. They are the same for both ends, because the offset enters only by
/// products of two of its components.
CURBSTONE_INLINE Votes votes_at(const Offsets& d, const Weights& weights) {
  const Floats w = weights.w;
  const Floats g = w / weights.squared;
  const Floats gx = g * d.x;
  const Floats gy = g * d.y;
  Votes votes;
  votes.component[VoteSums::kMass] = rounded(w);
  votes.component[VoteSums::kXX] = rounded(gx * d.x);
  votes.component[VoteSums::kXY] = rounded(gx * d.y);
  votes.component[VoteSums::kXZ] = rounded(gx * d.z);
  votes.component[VoteSums::kYY] = rounded(gy * d.y);
  votes.component[VoteSums::kYZ] = rounded(gy * d.z);
  return votes;
}

/// Moves a block's recent sums to its settled sums, rounding down.
void settle(VoterBlock* block, SettledSums* settled) {
  auto* const recent = reinterpret_cast<std::int32_t*>(&block->recent);
  auto* const sums = reinterpret_cast<std::int32_t*>(settled);
  for (int i = 0; i < VoteSums::kCount * kLanes; i += kWidth) {
    const auto received = load<Ints>(recent + i);
    store(sums + i, load<Ints>(sums + i) + (received >> kSettledBits));
    store(recent + i, received & kLessThanSettled);
  }
  block->num_recent = 0;
}

CURBSTONE_INLINE std::int64_t total_of(Ints recent) {
  HalfInts half[2];
  __builtin_memcpy(half, &recent, sizeof recent);
  const Longs wide = __builtin_convertvector(half[0], Longs) + __builtin_convertvector(half[1], Longs);
  std::int64_t total = 0;
  for (int lane = 0; lane < kWidth / 2; ++lane) total += wide[lane];
  return total;
}

/// The votes that the voter itself receives: 32-bit sums that settle regularly.
struct OwnSums {
  std::int64_t* settled;
  Ints recent[VoteSums::kCount] = {};
  int num_recent = 0;

  explicit CURBSTONE_INLINE OwnSums(std::int64_t* sums) : settled(sums) {}
  CURBSTONE_INLINE void settle() {
    for (int c = 0; c < VoteSums::kCount; ++c) {
      settled[c] += total_of(recent[c]);
      recent[c] = Ints{};
    }
    num_recent = 0;
  }
};

/// Offsets along one axis from `at` to voters of a block. The block's first voter and `at` may be on different sides of
/// a wrap.
CURBSTONE_INLINE Floats along(const std::int16_t* from_first, std::int32_t first, std::int32_t at) {
  const auto to_first = static_cast<std::int32_t>(static_cast<std::uint32_t>(first) - static_cast<std::uint32_t>(at));
  return __builtin_convertvector(__builtin_convertvector(load<Shorts>(from_first), Ints) + to_first, Floats);
}

/// Offsets from the voter to some voters of a block.
CURBSTONE_INLINE Offsets offsets_to(const VoterBlock* block, int lane, const StepPoint& at) {
  const auto* const x = reinterpret_cast<const std::int16_t*>(block) + lane;
  Offsets d;
  d.x = along(x, block->first.x, at.x);
  d.y = along(x + kLanes, block->first.y, at.y);
  d.z = along(x + 2 * kLanes, block->first.z, at.z);
  d.squared = d.x * d.x + d.y * d.y + d.z * d.z;
  return d;
}

CURBSTONE_INLINE Mask within_reach(const Decay& decay, const Offsets& d) {
  return below(below(d.squared, all(decay.radius2)), Floats{}, d.squared);
}

constexpr int kVectors = kLanes / kWidth;  // of a block

/// The votes between one voter and a block, in both directions.
CURBSTONE_INLINE void exchange_block(const StepPoint& at, const Weights* weights, const NearBlock* near, OwnSums& own) {
  auto* const received = reinterpret_cast<std::int32_t*>(&near->block->recent);
#pragma GCC unroll 4
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const Votes votes = votes_at(offsets_to(near->block, lane, at), weights[lane / kWidth]);
#pragma GCC unroll 6
    for (int c = 0; c < VoteSums::kCount; ++c) {
      own.recent[c] += votes.component[c];
      std::int32_t* const theirs = received + c * kLanes + lane;
      store(theirs, load<Ints>(theirs) + votes.component[c]);
    }
    if (++own.num_recent == kMaxRecent) own.settle();
  }
  if (++near->block->num_recent == kMaxRecent) settle(near->block, near->settled);
}

/// The votes between one voter and some blocks: first all weights, then the rest. Block by block, the operations that
/// depend on others of the same block would fill the processor's queue.
CURBSTONE_INLINE void exchange_blocks(const Decay& decay, const StepPoint& at, float sign,
                                      const NearBlock* const* blocks, std::size_t num_blocks, OwnSums& own) {
  constexpr std::size_t kAStep = 8;
  Weights weights[kAStep * kVectors];
  for (std::size_t begin = 0; begin < num_blocks; begin += kAStep) {
    const std::size_t count = num_blocks - begin < kAStep ? num_blocks - begin : kAStep;
    for (std::size_t i = 0; i < count; ++i) {
      for (int v = 0; v < kVectors; ++v) {
        const Offsets d = offsets_to(blocks[begin + i]->block, v * kWidth, at);
        weights[i * kVectors + static_cast<std::size_t>(v)] = weights_at(decay, sign, d, within_reach(decay, d));
      }
    }
    for (std::size_t i = 0; i < count; ++i) exchange_block(at, weights + i * kVectors, blocks[begin + i], own);
  }
}

/// Finds first which blocks have a voter within reach, and then computes the votes: the result of that test cannot be
/// predicted, and a branch misprediction costs as much as the votes of a block.
std::int64_t exchange(const Decay& decay, const StepPoint& at, float sign, NearBlock* near, std::size_t num_near,
                      std::int64_t* sums) {
  constexpr std::size_t kAtOnce = 64;
  OwnSums own(sums);
  std::int64_t total = 0;
  for (std::size_t begin = 0; begin < num_near; begin += kAtOnce) {
    const std::size_t end = begin + kAtOnce < num_near ? begin + kAtOnce : num_near;
    const NearBlock* within[kAtOnce];
    std::size_t num_within = 0;
    for (std::size_t i = begin; i < end; ++i) {
      int pairs = 0;
#pragma GCC unroll 4
      for (int lane = 0; lane < kLanes; lane += kWidth) {
        pairs += __builtin_popcount(bits(within_reach(decay, offsets_to(near[i].block, lane, at))));
      }
      near[i].pairs += pairs;
      total += pairs;
      within[num_within] = near + i;
      num_within += pairs > 0 ? 1 : 0;
    }
    exchange_blocks(decay, at, sign, within, num_within, own);
  }
  own.settle();
  return total;
}

/// Symmetric matrices during diagonalisation, and the axes of their present coordinates.
struct Matrices {
  Floats d[3];     // the diagonal
  Floats off[3];   // off[r]: the element that is neither in row nor column r
  Floats v[3][3];  // v[axis][component]
};

CURBSTONE_INLINE Floats size_of(Floats a) {
  return choose(below(a, Floats{}), -a, a);
}

/// One Jacobi rotation in the plane of all axes but r (Golub & Van Loan, 8.5.2): t = tan of the angle that zeroes
/// off[r], the smaller root of t^2 + t (aq - ap) / apq - 1 = 0.
template <int r>
CURBSTONE_INLINE void rotate(Matrices& m) {
  constexpr int p = r == 0 ? 1 : 0;
  constexpr int q = r == 2 ? 1 : 2;
  constexpr float kTiny = 1e-30F;    // so that 0 / 0 is 0
  constexpr float kNothing = 1e-9F;  // relative to a trace of 1: its square would be a denormal, which is slow
  m.off[r] = keep(below(all(kNothing), size_of(m.off[r])), m.off[r]);
  const Floats a = m.d[q] - m.d[p];
  const Floats b = m.off[r] + m.off[r];
  const Floats t = choose(below(a, Floats{}), -b, b) / (size_of(a) + root(a * a + b * b) + kTiny);
  const Floats c = 1.0F / root(t * t + 1.0F);
  const Floats s = t * c;
  m.d[p] -= t * m.off[r];
  m.d[q] += t * m.off[r];
  m.off[r] = Floats{};
  const Floats rp = m.off[q];  // row r, column p
  const Floats rq = m.off[p];
  m.off[q] = c * rp - s * rq;
  m.off[p] = s * rp + c * rq;
  for (int i = 0; i < 3; ++i) {
    const Floats vp = m.v[p][i];
    const Floats vq = m.v[q][i];
    m.v[p][i] = c * vp - s * vq;
    m.v[q][i] = s * vp + c * vq;
  }
}

/// Puts the larger eigenvalue first; of equal eigenvalues, the one with the steeper axis.
CURBSTONE_INLINE void order(Matrices& m, int first, int second) {
  const Mask larger = below(m.d[first], m.d[second]);
  const Mask smaller = below(m.d[second], m.d[first]);
  const Mask steeper = below(size_of(m.v[first][2]), size_of(m.v[second][2]));
  const Mask swap = larger | (static_cast<Mask>(~smaller) & steeper);
  const auto exchange = [&](Floats& a, Floats& b) {
    const Floats was = a;
    a = choose(swap, b, a);
    b = choose(swap, was, b);
  };
  exchange(m.d[first], m.d[second]);
  for (int i = 0; i < 3; ++i) exchange(m.v[first][i], m.v[second][i]);
}

/// Stores a vector as unit vector in the upper half space: z > 0; if z = 0 then y > 0; if that is 0 too, x > 0.
CURBSTONE_INLINE void store_upper(const Floats* v, Mask valid, const float* otherwise, float* to) {
  const Floats length = root(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  Floats sign = choose(below(v[0], Floats{}), all(-1), all(1));
  sign = choose(below(v[1], Floats{}), all(-1), choose(below(Floats{}, v[1]), all(1), sign));
  sign = choose(below(v[2], Floats{}), all(-1), choose(below(Floats{}, v[2]), all(1), sign));
  for (int i = 0; i < 3; ++i) store(to + i * kLanes, choose(valid, v[i] * sign / length, all(otherwise[i])));
}

/// Loads tensors, scaled to trace 1. Returns which of them have votes.
CURBSTONE_INLINE Mask load_scaled(const float* tensors, Matrices& m) {
  const auto element = [&](int i) { return load<Floats>(tensors + i * kLanes); };  // xx xy xz yy yz zz
  const Floats trace = element(0) + element(3) + element(5);
  const Floats total = size_of(element(1)) + size_of(element(2)) + size_of(element(4)) + trace;
  constexpr float kMaxTrace = 1e37F;
  const Mask valid = below(below(Floats{}, trace), total, all(kMaxTrace));
  const Floats scale = 1.0F / choose(valid, trace, all(1));
  const auto scaled = [&](int i) { return choose(valid, element(i), Floats{}) * scale; };
  m = {{scaled(0), scaled(3), scaled(5)}, {scaled(4), scaled(2), scaled(1)}, {}};
  for (int i = 0; i < 3; ++i) m.v[i][i] = all(1);
  return valid;
}

CURBSTONE_INLINE void store_shapes(Matrices& m, Mask valid, float* shapes) {
  constexpr float kUp[3] = {0, 0, 1};
  constexpr float kAhead[3] = {1, 0, 0};
  order(m, 0, 1);
  order(m, 1, 2);
  order(m, 0, 1);
  for (Floats& l : m.d) l = choose(below(Floats{}, l), l, Floats{});
  const Floats largest = choose(valid, m.d[0], all(1));
  store_upper(m.v[0], valid, kUp, shapes);
  store_upper(m.v[2], valid, kAhead, shapes + 3 * kLanes);
  store(shapes + 6 * kLanes, keep(valid, (m.d[0] - m.d[1]) / largest));
  store(shapes + 7 * kLanes, keep(valid, (m.d[1] - m.d[2]) / largest));
  store(shapes + 8 * kLanes, keep(valid, m.d[2] / largest));
}

/// Roots and divisions have a long latency: several vectors of tensors are processed at the same time.
template <std::size_t count>
CURBSTONE_INLINE void decompose_together(const float* const* tensors, float* const* shapes) {
  constexpr int kSweeps = 4;
  Matrices m[count];
  Mask valid[count];
  for (std::size_t i = 0; i < count; ++i) valid[i] = load_scaled(tensors[i], m[i]);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < count; ++i) rotate<2>(m[i]);
    for (std::size_t i = 0; i < count; ++i) rotate<1>(m[i]);
    for (std::size_t i = 0; i < count; ++i) rotate<0>(m[i]);
  }
  for (std::size_t i = 0; i < count; ++i) store_shapes(m[i], valid[i], shapes[i]);
}

void decompose(const float* tensors, float* shapes, std::size_t blocks) {
  constexpr std::size_t kTogether = 2;
  constexpr std::size_t kVectorsPerBlock = kLanes / kWidth;
  const std::size_t vectors = blocks * kVectorsPerBlock;
  const auto from = [&](std::size_t i) {
    return tensors + i / kVectorsPerBlock * kTensorFloats + i % kVectorsPerBlock * kWidth;
  };
  const auto to = [&](std::size_t i) {
    return shapes + i / kVectorsPerBlock * kShapeFloats + i % kVectorsPerBlock * kWidth;
  };
  std::size_t i = 0;
  for (; i + kTogether <= vectors; i += kTogether) {
    const float* const in[kTogether] = {from(i), from(i + 1)};
    float* const out[kTogether] = {to(i), to(i + 1)};
    decompose_together<kTogether>(in, out);
  }
  for (; i < vectors; ++i) {
    const float* const in[1] = {from(i)};
    float* const out[1] = {to(i)};
    decompose_together<1>(in, out);
  }
}

}  // namespace

extern const VoteKernel CURBSTONE_KERNEL;
const VoteKernel CURBSTONE_KERNEL = {CURBSTONE_KERNEL_NAME, exchange, decompose};

}  // namespace curbstone::tensor_voting::kernels
