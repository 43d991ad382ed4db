#pragma once

#include <Eigen/Core>

#include "services/tensor_voting/tensor.hpp"

namespace curbstone {

/// A tensor taken apart: T = (l1 - l2) e1 e1^T + (l2 - l3) (e1 e1^T + e2 e2^T) + l3 I, l1 >= l2 >= l3 >= 0.
struct Decomposition {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< e1: of the surface; unit, upper half space
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< e3: along the curve; unit, upper half space
  /// Shares of l1; they sum to 1 and do not depend on density. All 0 where nobody voted.
  double stick = 0;  ///< (l1 - l2) / l1: surface
  double plate = 0;  ///< (l2 - l3) / l1: curve, crease
  double ball = 0;   ///< l3 / l1: junction, volume
  double mass = 0;   ///< sum of the votes' weights
};

/// Eigenvalues by Jacobi rotations: additions, multiplications, divisions and roots only, hence the same bits
/// everywhere. Of a direction and its opposite the one with z > 0 is taken (if z = 0: y > 0, then x > 0); of equal
/// eigenvalues, the steeper axis comes first. A tensor that is not finite counts as one without votes.
[[nodiscard]] Decomposition decompose(const Tensor& tensor);

}  // namespace curbstone
