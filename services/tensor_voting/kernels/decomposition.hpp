#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "services/tensor_voting/kernels/tensor.hpp"

namespace curbstone::tensor_voting::kernels {

/// A decomposed tensor: T = (l1 - l2) e1 e1^T + (l2 - l3) (e1 e1^T + e2 e2^T) + l3 I, l1 >= l2 >= l3 >= 0.
template <class Scalar>
struct BasicDecomposition {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Vector3 normal = Vector3::UnitZ();   ///< e1: of the surface; unit, upper half space
  Vector3 tangent = Vector3::UnitX();  ///< e3: along the curve; unit, upper half space
  /// Shares of l1; they sum to 1 and do not depend on density. All 0 without votes.
  Scalar stick = 0;  ///< (l1 - l2) / l1: surface
  Scalar plate = 0;  ///< (l2 - l3) / l1: curve, crease
  Scalar ball = 0;   ///< l3 / l1: junction, volume
  Scalar mass = 0;   ///< sum of the votes' weights
};
using Decomposition = BasicDecomposition<double>;
using DecompositionF = BasicDecomposition<float>;

/// Eigenvalues by Jacobi rotations: only additions, multiplications, divisions and roots, so the bits are the same
/// everywhere. Of a direction and its opposite, the one with z > 0 is returned (if z = 0: y > 0, then x > 0). Of equal
/// eigenvalues, the one with the steeper axis comes first. A tensor that is not finite is treated as one without votes.
[[nodiscard]] Decomposition decompose(const Tensor& tensor);

/// The same for many tensors, in float and sixteen at a time: exact to 1e-6 of l1, also with the same bits everywhere.
[[nodiscard]] std::vector<DecompositionF> decompose(std::span<const TensorF> tensors);

}  // namespace curbstone::tensor_voting::kernels
