#pragma once

#include <cstdint>

#include "services/tensor_voting/cuda/host_device.hpp"
#include "services/tensor_voting/cuda/symmetric_eigen.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"

namespace curbstone::tensor_voting::cuda {

/// @file
/// The votes of one pair in batch voting, in the form that WarpGather requires. In float: exact to 1e-5 of a tensor's
/// norm.

struct LocalOffset {
  float x, y, z;
};
/// The offset from `origin` to `p`; exact within 2^24 steps.
CURBSTONE_HD inline LocalOffset offset_from(const kernels::StepPoint& origin, const kernels::StepPoint& p) {
  const auto minus = [](std::int32_t a, std::int32_t b) {
    return static_cast<float>(static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b)));
  };
  return {minus(p.x, origin.x), minus(p.y, origin.y), minus(p.z, origin.z)};
}
CURBSTONE_HD inline float squared(const LocalOffset& d) {
  return fused(d.x, d.x, fused(d.y, d.y, d.z * d.z));
}

/// w = 2^(exponent d^2) for 0 < d^2 < radius2, in steps.
struct BatchDecay {
  float exponent = 0;  ///< -log2(e) / sigma^2
  float radius2 = 0;
};

/// Common part of all kinds of votes: the points, relative to a nearby origin.
struct PointsOnDevice {
  const kernels::StepPoint* points = nullptr;

  CURBSTONE_HD kernels::StepPoint position(std::uint32_t i) const { return points[i]; }
  CURBSTONE_HD LocalOffset votee(std::uint32_t i, const kernels::StepPoint& origin) const {
    return offset_from(origin, points[i]);
  }
};

/// First pass: V = w (I - a u u^T), equation (B).
template <bool weighted>
struct BallVotes : PointsOnDevice {
  struct alignas(16) Voter {
    LocalOffset at;
    float weight;
  };
  using Votee = LocalOffset;
  struct Sums {
    float w = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0;  // sum of w, sums of w u u^T
  };

  BatchDecay decay;
  float ball = 1;
  const float* weights = nullptr;
  kernels::TensorF* tensors = nullptr;
  VotedShape* shapes = nullptr;

  CURBSTONE_HD Voter voter(std::uint32_t i, const kernels::StepPoint& origin) const {
    return {offset_from(origin, points[i]), weighted ? weights[i] : 1.0F};
  }
  CURBSTONE_HD void add(const Voter& voter, const Votee& votee, Sums& sums) const {
    const LocalOffset d = {voter.at.x - votee.x, voter.at.y - votee.y, voter.at.z - votee.z};
    const float d2 = squared(d);
    if (!(d2 > 0 && d2 < decay.radius2)) return;
    float w = approximate_exp2(decay.exponent * d2);
    if (weighted) w *= voter.weight;
    const float g = approximate_quotient(w, d2);
    const float gx = g * d.x;
    const float gy = g * d.y;
    sums.w += w;
    sums.xx = fused(gx, d.x, sums.xx);
    sums.xy = fused(gx, d.y, sums.xy);
    sums.xz = fused(gx, d.z, sums.xz);
    sums.yy = fused(gy, d.y, sums.yy);
    sums.yz = fused(gy, d.z, sums.yz);
  }
  CURBSTONE_HD void store(std::uint32_t i, const Sums& s) const {
    kernels::TensorF t;
    t.xx = s.w - ball * s.xx;
    t.xy = -ball * s.xy;
    t.xz = -ball * s.xz;
    t.yy = s.w - ball * s.yy;
    t.yz = -ball * s.yz;
    t.zz = s.w - ball * (s.w - s.xx - s.yy);
    t.mass = s.w;
    tensors[i] = t;
    shapes[i] = shape_of(t);
  }
};

/// Second pass: stick and plate votes of oriented tensors, formula (G), weighted by their saliencies.
///   stick: w (1 - (u.n)^2) (R n)(R n)^T,   R = I - 2 u u^T
///   plate: w R H R,  H = Q - ((u^T Q u) Q + 2 Q u u^T Q) / 4,  Q = I - t t^T
template <bool weighted>
struct OrientedVotes : PointsOnDevice {
  struct alignas(16) Voter {
    LocalOffset at;
    float stick;
    LocalOffset normal;
    float plate;
    LocalOffset tangent;
    float weight;
  };
  using Votee = LocalOffset;
  using Sums = kernels::TensorF;

  BatchDecay decay;
  const float* weights = nullptr;
  const VotedShape* oriented = nullptr;  ///< of the voters
  kernels::TensorF* tensors = nullptr;
  VotedShape* shapes = nullptr;

  CURBSTONE_HD Voter voter(std::uint32_t i, const kernels::StepPoint& origin) const {
    const VotedShape& s = oriented[i];
    return {offset_from(origin, points[i]),
            s.stick,
            {s.normal[0], s.normal[1], s.normal[2]},
            s.plate,
            {s.tangent[0], s.tangent[1], s.tangent[2]},
            weighted ? weights[i] : 1.0F};
  }
  CURBSTONE_HD void add(const Voter& voter, const Votee& votee, Sums& sums) const {
    const LocalOffset d = {voter.at.x - votee.x, voter.at.y - votee.y, voter.at.z - votee.z};
    const float d2 = squared(d);
    if (!(d2 > 0 && d2 < decay.radius2)) return;
    float w = approximate_exp2(decay.exponent * d2);
    if (weighted) w *= voter.weight;
    const float inverse = approximate_quotient(1.0F, d2);
    const auto dot = [&d](const LocalOffset& v) { return fused(d.x, v.x, fused(d.y, v.y, d.z * v.z)); };
    const auto reflected = [&d](const LocalOffset& v, float turn) {  // R v
      return LocalOffset{fused(-turn, d.x, v.x), fused(-turn, d.y, v.y), fused(-turn, d.z, v.z)};
    };

    const float dn = dot(voter.normal);
    const LocalOffset n = reflected(voter.normal, 2 * dn * inverse);
    const float stick = w * voter.stick * fused(-dn * dn, inverse, 1.0F);

    const float dt = dot(voter.tangent);
    const LocalOffset t = reflected(voter.tangent, 2 * dt * inverse);                       // R Q R = I - t t^T
    const LocalOffset v = {fused(dt, t.x, d.x), fused(dt, t.y, d.y), fused(dt, t.z, d.z)};  // -|d| R Q u
    const float plate = w * voter.plate;
    const float across = plate * fused(-0.25F, fused(-dt * dt, inverse, 1.0F), 1.0F);
    const float half = 0.5F * plate * inverse;

    sums.mass += w * (voter.stick + voter.plate);
    const auto element = [&](float ni, float nj, float ti, float tj, float vi, float vj, float sum) {
      return fused(stick * ni, nj, fused(-across * ti, tj, fused(-half * vi, vj, sum)));
    };
    sums.xx = element(n.x, n.x, t.x, t.x, v.x, v.x, sums.xx + across);
    sums.xy = element(n.x, n.y, t.x, t.y, v.x, v.y, sums.xy);
    sums.xz = element(n.x, n.z, t.x, t.z, v.x, v.z, sums.xz);
    sums.yy = element(n.y, n.y, t.y, t.y, v.y, v.y, sums.yy + across);
    sums.yz = element(n.y, n.z, t.y, t.z, v.y, v.z, sums.yz);
    sums.zz = element(n.z, n.z, t.z, t.z, v.z, v.z, sums.zz + across);
  }
  CURBSTONE_HD void store(std::uint32_t i, const Sums& sums) const {
    tensors[i] = sums;
    shapes[i] = shape_of(sums);
  }
};

/// Counts the points within reach, including the votee itself and its duplicates. Also gives the inverse of that count,
/// a voter's weight.
struct CountVotes : PointsOnDevice {
  struct alignas(16) Voter {
    LocalOffset at;
    float unused;
  };
  using Votee = LocalOffset;
  struct Sums {
    std::uint32_t count = 0;
  };

  float radius2 = 0;
  bool with_own_place = true;
  std::uint32_t* counts = nullptr;  ///< may be null
  float* weights = nullptr;         ///< may be null

  CURBSTONE_HD Voter voter(std::uint32_t i, const kernels::StepPoint& origin) const {
    return {offset_from(origin, points[i]), 0.0F};
  }
  CURBSTONE_HD void add(const Voter& voter, const Votee& votee, Sums& sums) const {
    const float d2 = squared({voter.at.x - votee.x, voter.at.y - votee.y, voter.at.z - votee.z});
    if (d2 < radius2 && (d2 > 0 || with_own_place)) ++sums.count;
  }
  CURBSTONE_HD void store(std::uint32_t i, const Sums& sums) const {
    if (counts != nullptr) counts[i] = sums.count;
    if (weights != nullptr) weights[i] = 1.0F / static_cast<float>(sums.count);
  }
};

}  // namespace curbstone::tensor_voting::cuda
