#pragma once

#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::registration {

/// A small change of a pose: translation, then rotation, in base_link axes: T <- T * exp_of(d).
[[nodiscard]] Vector6 log_of(const Pose& T);
[[nodiscard]] Pose exp_of(const Vector6& d);

/// Sums of one Gauss-Newton step over point-to-map distances: H d = -b.
struct NormalEquations {
  Matrix6 H = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  double weight = 0;         ///< sum of robust weights
  double lever = 0;          ///< sum of weight * squared distance of the point from base_link
  double squared_error = 0;  ///< of inliers, m^2
  int found = 0;             ///< points for which the map had a shape
  int inliers = 0;

  /// Adds a distance of `r` m of point `p` (base_link) along unit vector `n` (base_link axes), with weight `w`.
  void add(const Eigen::Vector3d& p, const Eigen::Vector3d& n, double r, double w) {
    Vector6 J;  // d r / d (translation, rotation)
    J << n, p.cross(n);
    H.noalias() += w * J * J.transpose();
    b += w * r * J;
    weight += w;
    lever += w * p.squaredNorm();
  }
};

/// The directions of the pose that the points constrain.
struct Observability {
  Matrix6 P = Matrix6::Identity();  ///< P H P^T and P b are the equations without the unconstrained directions
  int degenerate = 0;               ///< as in RegistrationResult
};

/// Computes the constrained directions. H is made unitless (rotations are divided by the mean lever arm, everything by
/// the sum of weights): an eigenvalue is then the mean squared cosine between its direction and the constraints.
/// Directions with an eigenvalue below `threshold` are projected out (solution remapping, Zhang, Kaess, Singh, ICRA
/// 2016).
[[nodiscard]] Observability observability(const NormalEquations& sum, double threshold);

}  // namespace curbstone::mapper::registration
