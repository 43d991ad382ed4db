#include "services/mapper/registration/normal_equations.hpp"

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"
#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::registration {

Vector6 log_of(const Pose& T) {
  const scan::Twist twist = scan::twist_of(T, 1.0);
  Vector6 out;
  out << twist.linear, twist.angular;
  return out;
}

Pose exp_of(const Vector6& d) {
  return scan::move({d.head<3>(), d.tail<3>()}, 1.0);
}

Observability observability(const NormalEquations& sum, double threshold) {
  if (!(sum.weight > 0)) return {Matrix6::Zero(), 0x3f};
  Observability out;
  const double lever = std::sqrt(std::max(sum.lever / sum.weight, 1e-6));
  Vector6 scale;
  scale << 1, 1, 1, 1 / lever, 1 / lever, 1 / lever;
  const Matrix6 D = scale.asDiagonal();
  const auto [lambda, vectors] = eigen_pairs<6>(D * sum.H * D / sum.weight);
  if (lambda[0] >= threshold) return out;
  Matrix6 keep = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector6 v = vectors.col(i);
    if (lambda[i] >= threshold) {
      keep += v * v.transpose();
      continue;
    }
    for (int axis = 0; axis < 6; ++axis) {
      if (std::abs(v[axis]) > 0.5) out.degenerate |= 1 << axis;
    }
  }
  out.P = inverse(D) * keep * D;  // acts on H from both sides in its own units
  return out;
}

}  // namespace curbstone::mapper::registration
