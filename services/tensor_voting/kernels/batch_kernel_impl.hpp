// The source of every batch kernel: compiled by batch_kernel_<isa>.cpp with that instruction set's flags, which define
// CURBSTONE_KERNEL. It must not call inline functions of other headers: the linker could keep the copy that was
// compiled for a machine that we are not on.

#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/kernels/lanes.hpp"

namespace curbstone::tensor_voting::kernels {
namespace {

constexpr float kUnit = 1.0F / (1 << 20);  // of steps

/// The voters near a block of votees, in units from the block's middle.
struct NearVoters {
  static constexpr std::size_t kCapacity = 1024;
  std::size_t size = 0;
  float x[kCapacity + kBlock];
  float y[kCapacity + kBlock];
  float z[kCapacity + kBlock];
  std::uint32_t index[kCapacity + kBlock];

  [[nodiscard]] CURBSTONE_INLINE bool full() const { return size + kBlock > kCapacity; }
};

/// A few votees side by side. Lanes in use for nobody repeat the first votee; their sums are not looked at.
struct Votees {
  float x[kBlock];
  float y[kBlock];
  float z[kBlock];
  std::int32_t middle[3];
  float extent;  // all are within it of the middle, units
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
      out[axis][i] = static_cast<float>(from_first(i < count ? i : 0) - middle) * kUnit;
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

/// Takes voters from the front of `run` that can reach some votee, until the run or the room is used up.
CURBSTONE_INLINE void collect(const VoterArrays& voters, VoterRun& run, const Votees& votees, float reach2,
                              NearVoters& near) {
  constexpr auto kStep = static_cast<std::uint32_t>(kWidth);
  Ints lane;
  for (int i = 0; i < kWidth; ++i) lane[i] = i;
  while (run.count > 0 && !near.full()) {
    const Floats x = difference(load<Ints>(voters.x + run.begin), votees.middle[0]) * kUnit;
    const Floats y = difference(load<Ints>(voters.y + run.begin), votees.middle[1]) * kUnit;
    const Floats z = difference(load<Ints>(voters.z + run.begin), votees.middle[2]) * kUnit;
    Mask mask = below(x * x + y * y + z * z, all(reach2));
    if (run.count < kStep)
      mask = below(mask, __builtin_convertvector(lane, Floats), all(static_cast<float>(run.count)));
    store_packed(near.x + near.size, mask, x);
    store_packed(near.y + near.size, mask, y);
    store_packed(near.z + near.size, mask, z);
    store_packed(near.index + near.size, mask, lane + static_cast<std::int32_t>(run.begin));
    near.size += static_cast<unsigned>(__builtin_popcount(bits(mask)));
    const std::uint32_t taken = run.count < kStep ? run.count : kStep;
    run.begin += taken;
    run.count -= taken;
  }
}

/// exp(-decay d2), to 1e-6, as (exp(-decay d2 / 16))^16: a polynomial of degree 5 and four squarings, no table, no
/// exponent to assemble. For decay d2 <= 9.6.
struct NearDecay {
  static constexpr float kLimit = 9.6F;
  Floats c1, c2, c3, c4, c5;
  explicit CURBSTONE_INLINE NearDecay(float decay) {
    // Chebyshev interpolation of exp(-t) on [0, 0.6].
    const float t = decay / 16;
    c1 = all(-0.9999970513F * t);
    c2 = all(0.4999423005F * t * t);
    c3 = all(-0.1662509501F * t * t * t);
    c4 = all(0.0402966153F * t * t * t * t);
    c5 = all(-0.0061933564F * t * t * t * t * t);
  }
  CURBSTONE_INLINE Floats operator()(Floats d2) const {
    Floats p = c5 * d2 + c4;
    p = p * d2 + c3;
    p = p * d2 + c2;
    p = p * d2 + c1;
    p = p * d2 + 1.0F;
    p *= p;
    p *= p;
    p *= p;
    return p * p;
  }
};

/// The same for any distance: 2^n e^r.
struct FarDecay {
  Floats decay;
  explicit CURBSTONE_INLINE FarDecay(float d) : decay(all(-d)) {}
  CURBSTONE_INLINE Floats operator()(Floats d2) const {
    const Floats exact = d2 * decay;
    const Floats x = choose(below(all(-80.0F), exact), exact, all(-80.0F));
    const Floats n = __builtin_convertvector(rounded(x * 1.44269504F), Floats);
    const Floats r = (x - n * 0.693359375F) + n * 2.12194440e-4F;
    Floats p = r * (1.0F / 720) + 1.0F / 120;
    p = p * r + 1.0F / 24;
    p = p * r + 1.0F / 6;
    p = p * r + 0.5F;
    p = p * r + 1.0F;
    p = p * r + 1.0F;
    const Ints exponent = (__builtin_convertvector(n, Ints) + 127) << 23;
    return p * __builtin_bit_cast(Floats, exponent);
  }
};

/// Votees in the lanes of a vector, and the offsets of one voter from them.
struct VoteeLanes {
  Floats x, y, z;
};
struct Offset {
  Floats x, y, z, squared;
  Mask within;  // 0 < d < radius
};
// Added to d^2, so that 1 / d^2 is finite where d is 0; beyond the resolution of every other distance.
constexpr float kTiny = 1e-20F;

CURBSTONE_INLINE Offset offset_of(const VoteeLanes& votee, const NearVoters& near, std::size_t i, Floats radius2) {
  Offset d;
  d.x = votee.x - near.x[i];
  d.y = votee.y - near.y[i];
  d.z = votee.z - near.z[i];
  d.squared = d.z * d.z + (d.y * d.y + (d.x * d.x + kTiny));
  d.within = below(below(d.squared, radius2), all(2 * kTiny), d.squared);
  return d;
}

/// 1 / a to float precision: one Newton step.
CURBSTONE_INLINE Floats reciprocal_times(Floats a, Floats times) {
  const Floats r = rough_reciprocal(a);
  return (times * r) * (2.0F - a * r);
}

/// Ball votes: sums of w and of w u u^T.
struct BallSums {
  static constexpr int kComponents = 6;
  Floats sum[kComponents] = {};

  template <bool weighted, class Decay>
  CURBSTONE_INLINE void add(const Offset& d, const Decay& decay, const VoterArrays& voters, std::uint32_t voter) {
    Floats w = keep(d.within, decay(d.squared));
    if constexpr (weighted) w *= voters.weight[voter];
    const Floats g = reciprocal_times(d.squared, w);
    const Floats gx = g * d.x;
    const Floats gy = g * d.y;
    sum[0] += w;
    sum[1] += gx * d.x;
    sum[2] += gx * d.y;
    sum[3] += gx * d.z;
    sum[4] += gy * d.y;
    sum[5] += gy * d.z;
  }
};

/// Stick and plate votes of formula (G), with r = d d^T / d^2 and R = I - 2 r:
///   stick  w (1 - (u.n)^2) n' n'^T,                      n' = R n
///   plate  w ((1 - q/4) (I - t' t'^T) - v v^T / 2),      t' = R t, q = 1 - (u.t)^2, v = u + (u.t) t'
/// since R Q R = I - t' t'^T and R Q u = -v for Q = I - t t^T.
struct OrientedSums {
  static constexpr int kComponents = 7;
  Floats sum[kComponents] = {};

  template <bool weighted, class Decay>
  CURBSTONE_INLINE void add(const Offset& d, const Decay& decay, const VoterArrays& voters, std::uint32_t index) {
    const OrientedVoter& voter = voters.oriented[index];
    Floats w = keep(d.within, decay(d.squared));
    if constexpr (weighted) w *= voters.weight[index];
    const Floats inverse = reciprocal_times(d.squared, all(1));

    const float* const n = voter.normal;
    const Floats dn = d.x * n[0] + d.y * n[1] + d.z * n[2];
    const Floats turn_n = 2.0F * dn * inverse;
    const Floats nx = n[0] - turn_n * d.x;
    const Floats ny = n[1] - turn_n * d.y;
    const Floats nz = n[2] - turn_n * d.z;
    const Floats stick = w * voter.stick * (1.0F - dn * dn * inverse);

    const float* const t = voter.tangent;
    const Floats dt = d.x * t[0] + d.y * t[1] + d.z * t[2];
    const Floats turn_t = 2.0F * dt * inverse;
    const Floats tx = t[0] - turn_t * d.x;
    const Floats ty = t[1] - turn_t * d.y;
    const Floats tz = t[2] - turn_t * d.z;
    const Floats q = 1.0F - dt * dt * inverse;
    const Floats plate = w * voter.plate;
    const Floats across = plate * (1.0F - 0.25F * q);
    const Floats half = 0.5F * plate * inverse;
    const Floats vx = d.x + dt * tx;
    const Floats vy = d.y + dt * ty;
    const Floats vz = d.z + dt * tz;

    sum[0] += w * (voter.stick + voter.plate);
    sum[1] += stick * nx * nx + across * (1.0F - tx * tx) - half * vx * vx;
    sum[2] += stick * nx * ny - across * tx * ty - half * vx * vy;
    sum[3] += stick * nx * nz - across * tx * tz - half * vx * vz;
    sum[4] += stick * ny * ny + across * (1.0F - ty * ty) - half * vy * vy;
    sum[5] += stick * ny * nz - across * ty * tz - half * vy * vz;
    sum[6] += stick * nz * nz + across * (1.0F - tz * tz) - half * vz * vz;
  }
};

/// Weights of all within reach, without decay.
struct Within {
  Floats radius2;
};
struct Count {
  static constexpr int kComponents = 1;
  Floats sum[kComponents] = {};

  template <bool weighted, class Decay>
  CURBSTONE_INLINE void add(const Offset& d, const Decay& within, const VoterArrays& voters, std::uint32_t voter) {
    const Mask near = below(d.squared, within.radius2);
    sum[0] += keep(near, all(weighted ? voters.weight[voter] : 1.0F));
  }
};

template <class Sums, bool weighted, class Decay>
void show(const VoterArrays& voters, const NearVoters& near, const Votees& votees, const Decay& decay, float radius2,
          float* votes) {
  for (int lane = 0; lane < kBlock; lane += kWidth) {
    const VoteeLanes place{load<Floats>(votees.x + lane), load<Floats>(votees.y + lane), load<Floats>(votees.z + lane)};
    const Floats limit = all(radius2);
    Sums sums;
    for (std::size_t i = 0; i < near.size; ++i) {
      sums.template add<weighted>(offset_of(place, near, i, limit), decay, voters, near.index[i]);
    }
    for (int c = 0; c < Sums::kComponents; ++c) {
      float* const to = votes + c * kBlock + lane;
      store(to, load<Floats>(to) + sums.sum[c]);
    }
  }
}

template <class Sums, class Decay>
void vote(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
          std::uint32_t count, const BatchScale& scale, const Decay& decay, float* votes) {
  __builtin_memset(votes, 0, sizeof(float) * kBlock * Sums::kComponents);
  const Votees votees = votees_of(voters, first, count);
  const float reach = (scale.radius + votees.extent) * 1.00001F;
  const float radius2 = scale.radius * scale.radius;
  NearVoters near;
  const auto show_all = [&] {
    if (voters.weight == nullptr) {
      show<Sums, false>(voters, near, votees, decay, radius2, votes);
    } else {
      show<Sums, true>(voters, near, votees, decay, radius2, votes);
    }
    near.size = 0;
  };
  for (const VoterRun* next = runs; next != runs + num_runs; ++next) {
    VoterRun run = *next;
    while (run.count > 0) {
      if (near.full()) show_all();
      collect(voters, run, votees, reach * reach, near);
    }
  }
  show_all();
}

template <class Sums>
void vote_with_decay(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
                     std::uint32_t count, const BatchScale& scale, float* votes) {
  if (scale.decay * scale.radius * scale.radius <= NearDecay::kLimit) {
    vote<Sums>(voters, runs, num_runs, first, count, scale, NearDecay(scale.decay), votes);
  } else {
    vote<Sums>(voters, runs, num_runs, first, count, scale, FarDecay(scale.decay), votes);
  }
}

void ball(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
          std::uint32_t count, const BatchScale& scale, float* votes) {
  vote_with_decay<BallSums>(voters, runs, num_runs, first, count, scale, votes);
}
void oriented(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
              std::uint32_t count, const BatchScale& scale, float* votes) {
  vote_with_decay<OrientedSums>(voters, runs, num_runs, first, count, scale, votes);
}
void count(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
           std::uint32_t count, const BatchScale& scale, float* votes) {
  vote<Count>(voters, runs, num_runs, first, count, scale, Within{all(scale.radius * scale.radius)}, votes);
}

}  // namespace

extern const BatchKernel CURBSTONE_KERNEL;
const BatchKernel CURBSTONE_KERNEL = {CURBSTONE_KERNEL_NAME, ball, oriented, count};

}  // namespace curbstone::tensor_voting::kernels
