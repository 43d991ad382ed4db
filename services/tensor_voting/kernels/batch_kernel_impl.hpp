// The source of every batch kernel: compiled by batch_kernel_<isa>.cpp with that instruction set's flags, which define
// CURBSTONE_KERNEL. It must not call inline functions of other headers: the linker could keep the copy that was
// compiled for another machine.

#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/kernels/lanes.hpp"
#include "services/tensor_voting/kernels/near_voters.hpp"

namespace curbstone::tensor_voting::kernels {
namespace {

constexpr int kTogether = kWidth < kBlock ? 1 : kWidth / kBlock;  // voters at a time
constexpr int kVotees = kWidth / kTogether;                       // votees at a time
constexpr int kStride = 16;                                       // vectors of pairs in one step

// With two voters at a time, lanes 2 k and 2 k + 1 belong to votee k.
CURBSTONE_INLINE Floats of_votees(const float* votees) {
#if defined(__AVX512F__)
  const auto v = load<HalfFloats>(votees);
  return __builtin_shufflevector(v, v, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
#else
  return load<Floats>(votees);
#endif
}
CURBSTONE_INLINE Floats of_voters(const float* voters) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(Floats, Longs{} + load<std::int64_t>(voters));
#else
  return all(*voters);
#endif
}
CURBSTONE_INLINE void add_to_votees(float* votees, Floats sum) {
#if defined(__AVX512F__)
  const HalfFloats first = __builtin_shufflevector(sum, sum, 0, 2, 4, 6, 8, 10, 12, 14);
  const HalfFloats second = __builtin_shufflevector(sum, sum, 1, 3, 5, 7, 9, 11, 13, 15);
  store(votees, load<HalfFloats>(votees) + (first + second));
#else
  store(votees, load<Floats>(votees) + sum);
#endif
}
/// Loads the values `of` for the voters at `index`.
template <class Of>
CURBSTONE_INLINE Floats of_voters(const std::uint32_t* index, const Of& of) {
  float voters[kTogether];
  for (int i = 0; i < kTogether; ++i) voters[i] = of(index[i]);
  return of_voters(voters);
}

/// exp(-decay d2), to 3e-6: a power of two times 2^f, -1/2 <= f <= 1/2, by its minimax polynomial of degree 4. Unless
/// `far`, it is valid only for decay d2 <= kLimit.
template <bool far>
struct Gauss {
  static constexpr float kLimit = 87;
  Floats scale;
  explicit CURBSTONE_INLINE Gauss(float decay) : scale(all(-1.44269504F * decay)) {}
  CURBSTONE_INLINE Floats operator()(Floats d2) const {
    constexpr float kRounder = 12582912.0F;  // 1.5 * 2^23: adding it leaves the nearest whole number in the low bits
    Floats shifted = d2 * scale + kRounder;
    Floats f = d2 * scale - (shifted - kRounder);
    if constexpr (far) {
      const Mask tiny = below(shifted, all(kRounder - 126));
      shifted = choose(tiny, all(kRounder - 126), shifted);
      f = choose(tiny, Floats{}, f);
    }
    Floats p = 0.00957010191F * f + 0.0559178603F;
    p = p * f + 0.240247448F;
    p = p * f + 0.693121815F;
    p = p * f + 0.999999261F;
    const Ints exponent = __builtin_bit_cast(Ints, shifted) << 23;
    return __builtin_bit_cast(Floats, __builtin_bit_cast(Ints, p) + exponent);
  }
};

/// The decay of voters that are only counted.
struct NoDecay {
  CURBSTONE_INLINE Floats operator()(Floats) const { return all(1); }
};

/// Votees in the lanes of a vector, and the offsets of voters from them.
struct VoteeLanes {
  Floats x, y, z;
};
struct Offset {
  Floats x, y, z;
};
CURBSTONE_INLINE Offset offset_of(const VoteeLanes& votee, const NearVoters& near, std::size_t i) {
  return {votee.x - of_voters(near.x + i), votee.y - of_voters(near.y + i), votee.z - of_voters(near.z + i)};
}
// Added to d^2, so that 1 / d^2 is finite where d is 0; negligible compared with one step.
constexpr float kTiny = 1e-9F;
CURBSTONE_INLINE Floats squared(const Offset& d) {
  return d.z * d.z + (d.y * d.y + (d.x * d.x + kTiny));
}

/// Ball votes: sums of w and of w u u^T.
struct BallSums {
  static constexpr int kComponents = 6;
  static constexpr bool kIncludesSelf = false;
  static constexpr bool kReadsVoters = false;
  Floats sum[kComponents];

  CURBSTONE_INLINE void add(const Offset& d, Floats squared, Floats w, const VoterArrays&, const std::uint32_t*) {
    const Floats g = w / squared;
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
  static constexpr bool kIncludesSelf = false;
  static constexpr bool kReadsVoters = true;
  Floats sum[kComponents];

  CURBSTONE_INLINE void add(const Offset& d, Floats squared, Floats w, const VoterArrays& voters,
                            const std::uint32_t* index) {
    const auto oriented = [&](auto of) {
      return of_voters(index, [&](std::uint32_t voter) { return of(voters.oriented[voter]); });
    };
    const Floats inverse = 1.0F / squared;
    const Floats voter_stick = oriented([](const OrientedVoter& v) { return v.stick; });
    const Floats voter_plate = oriented([](const OrientedVoter& v) { return v.plate; });

    Floats n[3];
    for (int axis = 0; axis < 3; ++axis) n[axis] = oriented([&](const OrientedVoter& v) { return v.normal[axis]; });
    const Floats dn = d.x * n[0] + d.y * n[1] + d.z * n[2];
    const Floats turn_n = 2.0F * dn * inverse;
    const Floats nx = n[0] - turn_n * d.x;
    const Floats ny = n[1] - turn_n * d.y;
    const Floats nz = n[2] - turn_n * d.z;
    const Floats stick = w * voter_stick * (1.0F - dn * dn * inverse);

    Floats t[3];
    for (int axis = 0; axis < 3; ++axis) t[axis] = oriented([&](const OrientedVoter& v) { return v.tangent[axis]; });
    const Floats dt = d.x * t[0] + d.y * t[1] + d.z * t[2];
    const Floats turn_t = 2.0F * dt * inverse;
    const Floats tx = t[0] - turn_t * d.x;
    const Floats ty = t[1] - turn_t * d.y;
    const Floats tz = t[2] - turn_t * d.z;
    const Floats q = 1.0F - dt * dt * inverse;
    const Floats plate = w * voter_plate;
    const Floats across = plate * (1.0F - 0.25F * q);
    const Floats half = 0.5F * plate * inverse;
    const Floats vx = d.x + dt * tx;
    const Floats vy = d.y + dt * ty;
    const Floats vz = d.z + dt * tz;

    sum[0] += w * (voter_stick + voter_plate);
    sum[1] += stick * nx * nx + across * (1.0F - tx * tx) - half * vx * vx;
    sum[2] += stick * nx * ny - across * tx * ty - half * vx * vy;
    sum[3] += stick * nx * nz - across * tx * tz - half * vx * vz;
    sum[4] += stick * ny * ny + across * (1.0F - ty * ty) - half * vy * vy;
    sum[5] += stick * ny * nz - across * ty * tz - half * vy * vz;
    sum[6] += stick * nz * nz + across * (1.0F - tz * tz) - half * vz * vz;
  }
};

/// Sum of the weights alone.
struct Count {
  static constexpr int kComponents = 1;
  static constexpr bool kIncludesSelf = true;
  static constexpr bool kReadsVoters = false;
  Floats sum[kComponents];

  CURBSTONE_INLINE void add(const Offset&, Floats, Floats w, const VoterArrays&, const std::uint32_t*) { sum[0] += w; }
};

/// Processes voters first .. last - 1 of `near` for some votees, in three steps of many voters each. Voter by voter,
/// the operations that depend on others of the same voter would fill the processor's queue, and it would stall.
template <class Sums, bool weighted, class Decay>
CURBSTONE_INLINE void show(const VoterArrays& voters, const NearVoters& near, std::size_t first, std::size_t last,
                           const VoteeLanes& votee, const Decay& decay, float radius2, Sums& sums) {
  Floats d2[kStride];
  Floats w[kStride];
  std::size_t k = 0;
  for (std::size_t i = first; i < last; i += kTogether) d2[k++] = squared(offset_of(votee, near, i));
  k = 0;
  for (std::size_t i = first; i < last; i += kTogether, ++k) {
    w[k] = keep(between(Sums::kIncludesSelf ? 0 : 2 * kTiny, d2[k], radius2), decay(d2[k]));
    if constexpr (weighted) {
      w[k] *= of_voters(near.index + i, [&](std::uint32_t voter) { return voters.weight[voter]; });
    }
  }
  k = 0;
  for (std::size_t i = first; i < last; i += kTogether, ++k) {
    sums.add(offset_of(votee, near, i), d2[k], w[k], voters, near.index + i);
  }
}

template <class Sums, bool weighted, class Decay>
void show_all(const VoterArrays& voters, NearVoters& near, const Votees& votees, const Decay& decay, float radius,
              float* votes) {
  near.pad(kTogether, 2 * (radius + votees.extent));
  for (int place = 0; place < kBlock; place += kVotees) {
    const VoteeLanes votee{of_votees(votees.x + place), of_votees(votees.y + place), of_votees(votees.z + place)};
    Sums sums;
    for (Floats& sum : sums.sum) sum = Floats{};
    constexpr std::size_t kStep = kStride * kTogether;
    for (std::size_t i = 0; i < near.size; i += kStep) {
      const std::size_t last = i + kStep < near.size ? i + kStep : near.size;
      show<Sums, weighted>(voters, near, i, last, votee, decay, radius * radius, sums);
    }
    for (int c = 0; c < Sums::kComponents; ++c) add_to_votees(votes + c * kBlock + place, sums.sum[c]);
  }
  near.size = 0;
}

template <class Sums, bool weighted, class Decay>
void vote(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, const Votees& votees, float radius,
          const Decay& decay, float* votes) {
  const float reach = (radius + votees.extent) * 1.00001F;
  NearVoters near;
  for (const VoterRun* next = runs; next != runs + num_runs; ++next) {
    VoterRun run = *next;
    near.collect<weighted || Sums::kReadsVoters>(voters, run, votees, reach);
    while (run.count > 0) {
      show_all<Sums, weighted>(voters, near, votees, decay, radius, votes);
      near.collect<weighted || Sums::kReadsVoters>(voters, run, votees, reach);
    }
  }
  show_all<Sums, weighted>(voters, near, votees, decay, radius, votes);
}

template <class Sums, class Decay>
void vote(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, const Votees& votees, float radius,
          const Decay& decay, float* votes) {
  __builtin_memset(votes, 0, sizeof(float) * kBlock * Sums::kComponents);
  if (voters.weight == nullptr) {
    vote<Sums, false>(voters, runs, num_runs, votees, radius, decay, votes);
  } else {
    vote<Sums, true>(voters, runs, num_runs, votees, radius, decay, votes);
  }
}

template <class Sums>
void vote(const VoterArrays& voters, const VoterRun* runs, std::size_t num_runs, std::uint32_t first,
          std::uint32_t count, const BatchScale& scale, float* votes) {
  const Votees votees = votees_of(voters, first, count);
  const float radius = scale.radius * kStepsPerUnit;
  const float decay = scale.decay / (kStepsPerUnit * kStepsPerUnit);
  if constexpr (Sums::kIncludesSelf) {
    vote<Sums>(voters, runs, num_runs, votees, radius, NoDecay{}, votes);
  } else {
    if (decay * radius * radius <= Gauss<false>::kLimit) {
      vote<Sums>(voters, runs, num_runs, votees, radius, Gauss<false>(decay), votes);
    } else {
      vote<Sums>(voters, runs, num_runs, votees, radius, Gauss<true>(decay), votes);
    }
  }
}

}  // namespace

extern const BatchKernel CURBSTONE_KERNEL;
const BatchKernel CURBSTONE_KERNEL = {CURBSTONE_KERNEL_NAME, vote<BallSums>, vote<OrientedSums>, vote<Count>};

}  // namespace curbstone::tensor_voting::kernels
