#pragma once

#include <cmath>

#include "services/tensor_voting/cuda/host_device.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"

namespace curbstone::tensor_voting::cuda {

/// A decomposed tensor: DecompositionF, without Eigen.
struct VotedShape {
  float normal[3] = {0, 0, 1};
  float tangent[3] = {1, 0, 0};
  float stick = 0;
  float plate = 0;
  float ball = 0;
  float mass = 0;
};

/// A symmetric matrix during diagonalisation, and the axes of its present coordinates.
struct JacobiState {
  float diagonal[3];
  float off[3];      ///< off[r]: the element that is neither in row nor in column r
  float axis[3][3];  ///< axis[i]: belongs to diagonal[i]

  /// The rotation in the plane of all axes but r (Golub & Van Loan, 8.5.2): t = tan of the angle that zeroes off[r],
  /// the smaller root of t^2 + t (aq - ap) / apq - 1 = 0.
  template <int r>
  CURBSTONE_HD void rotate() {
    constexpr int p = r == 0 ? 1 : 0;
    constexpr int q = r == 2 ? 1 : 2;
    const float a = diagonal[q] - diagonal[p];
    const float b = 2 * off[r];
    const float size = ::fabsf(a) + ::sqrtf(a * a + b * b);
    const float t = size > 0 ? (a < 0 ? -b : b) / size : 0.0F;
    const float c = 1 / ::sqrtf(t * t + 1);
    const float s = t * c;
    diagonal[p] -= t * off[r];
    diagonal[q] += t * off[r];
    off[r] = 0;
    const float rp = off[q];  // row r, column p
    const float rq = off[p];
    off[q] = c * rp - s * rq;
    off[p] = s * rp + c * rq;
    for (int i = 0; i < 3; ++i) {
      const float vp = axis[p][i];
      const float vq = axis[q][i];
      axis[p][i] = c * vp - s * vq;
      axis[q][i] = s * vp + c * vq;
    }
  }

  /// Puts the larger eigenvalue first; of equal eigenvalues, the one with the steeper axis.
  template <int first, int second>
  CURBSTONE_HD void order() {
    const bool swap = diagonal[first] < diagonal[second] ||
                      (diagonal[first] == diagonal[second] && ::fabsf(axis[first][2]) < ::fabsf(axis[second][2]));
    const auto exchange = [swap](float& a, float& b) {
      const float was = a;
      a = swap ? b : a;
      b = swap ? was : b;
    };
    exchange(diagonal[first], diagonal[second]);
    for (int i = 0; i < 3; ++i) exchange(axis[first][i], axis[second][i]);
  }

  /// Stores a vector as unit vector in the upper half space: z > 0; if z = 0 then y > 0; if that is 0 too, x > 0.
  CURBSTONE_HD static void store_upper(const float* v, float* to) {
    const bool down = v[2] < 0 || (v[2] == 0 && (v[1] < 0 || (v[1] == 0 && v[0] < 0)));
    const float scale = (down ? -1.0F : 1.0F) / ::sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; ++i) to[i] = v[i] == 0 ? 0.0F : v[i] * scale;
  }
};

/// Eigenvalues and eigenvectors by Jacobi rotations, with the conventions of decompose(). The shares of a tensor
/// without votes, or of one that is not finite, are 0.
CURBSTONE_HD inline VotedShape shape_of(const kernels::TensorF& tensor) {
  constexpr int kSweeps = 4;  // quadratic convergence
  VotedShape shape;
  const float trace = tensor.xx + tensor.yy + tensor.zz;
  const float all = trace + ::fabsf(tensor.xy) + ::fabsf(tensor.xz) + ::fabsf(tensor.yz);
  if (!(trace > 0 && all < 1e37F)) return shape;
  const float s = 1 / trace;
  JacobiState m = {{tensor.xx * s, tensor.yy * s, tensor.zz * s},
                   {tensor.yz * s, tensor.xz * s, tensor.xy * s},
                   {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    m.rotate<2>();
    m.rotate<1>();
    m.rotate<0>();
  }
  m.order<0, 1>();
  m.order<1, 2>();
  m.order<0, 1>();
  const float l1 = m.diagonal[0];
  const float l2 = larger(m.diagonal[1], 0.0F);
  const float l3 = larger(m.diagonal[2], 0.0F);
  JacobiState::store_upper(m.axis[0], shape.normal);
  JacobiState::store_upper(m.axis[2], shape.tangent);
  shape.stick = (l1 - l2) / l1;
  shape.plate = (l2 - l3) / l1;
  shape.ball = l3 / l1;
  shape.mass = tensor.mass;
  return shape;
}

}  // namespace curbstone::tensor_voting::cuda
