#pragma once

#include <array>
#include <cstdint>

namespace curbstone::tensor_voting::kernels {

/// A symmetric 3x3 tensor, and the mass W = sum w(d) of its votes. The identity that some implementations give every
/// point initially (T0) is left out: it only adds to the ball, and shares would then depend on density.
template <class Scalar>
struct BasicTensor {
  Scalar xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Scalar mass = 0;
};
using Tensor = BasicTensor<double>;
using TensorF = BasicTensor<float>;  ///< for the many points of a cloud

[[nodiscard]] inline TensorF to_float(const Tensor& t) {
  const auto f = [](double v) { return static_cast<float>(v); };
  return {f(t.xx), f(t.xy), f(t.xz), f(t.yy), f(t.yz), f(t.zz), f(t.mass)};
}

/// Sums of votes in fixed point. Sums of integers do not depend on their order. The result is therefore independent of
/// the order of arrival, the number of threads or workers, and anything that was added and removed in between.
///
/// One vote is at most 1, that is 2^27 units; 2^28 voters fit (SettledSums). A vote is rounded to the nearest unit: an
/// error of 3e-5 of the weakest possible vote (w(3 sigma) = 1.2e-4), 1e-9 of a typical sum.
struct VoteSums {
  enum Component { kMass, kXX, kXY, kXZ, kYY, kYZ, kCount };  ///< sum of w and sums of w u u^T; zz = mass - xx - yy
  std::array<std::int64_t, kCount> value{};

  bool operator==(const VoteSums&) const = default;
};
inline constexpr float kUnitsPerVote = 1 << 27;
inline constexpr double kVoteUnit = 1.0 / double{kUnitsPerVote};

/// T = sum w (I - ball u u^T) = W I - ball S.
[[nodiscard]] inline Tensor to_tensor(const VoteSums& sums, double ball) {
  const auto at = [&](VoteSums::Component c) { return static_cast<double>(sums.value[c]) * kVoteUnit; };
  const double mass = at(VoteSums::kMass);
  const double xx = at(VoteSums::kXX);
  const double yy = at(VoteSums::kYY);
  return {.xx = mass - ball * xx,
          .xy = -ball * at(VoteSums::kXY),
          .xz = -ball * at(VoteSums::kXZ),
          .yy = mass - ball * yy,
          .yz = -ball * at(VoteSums::kYZ),
          .zz = mass - ball * (mass - xx - yy),
          .mass = mass};
}

}  // namespace curbstone::tensor_voting::kernels
