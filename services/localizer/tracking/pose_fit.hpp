#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/localizer/fields/saved_map.hpp"
#include "services/localizer/tracking/thinned_scan.hpp"
#include "services/localizer/tracking/tracking_config.hpp"

namespace curbstone::localizer::tracking {

/// Covariance of a pose. Rows 0..2: position in map's axes, m; 3..5: rotation about base_link's X Y Z, rad. As in
/// map_pose_t.
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// A pose and its covariance.
struct PoseBelief {
  Pose T_map_base = Pose::Identity();
  Matrix6 covariance = Matrix6::Identity();
};

/// The result of registering a revolution with the map.
struct PoseFit {
  PoseBelief belief;                      ///< posterior: prior and revolution together
  Matrix6 information = Matrix6::Zero();  ///< of the revolution alone, if all its points were independent
  int degenerate = 0;  ///< bit i: the revolution does not constrain axis i of base_link; see map_pose_t
  int iterations = 0;
  double residual = 0;       ///< m, RMS over the points that match the map
  int uprights = 0;          ///< points on upright structures, where the map knows the ground around them
  int uprights_matched = 0;  ///< of them, those with an upright structure in the map at that place
  int grounds = 0;           ///< points on the ground, where the map has ground
  int grounds_matched = 0;   ///< of them, those at the map's height

  /// 0..1: the lesser of the two shares; 0 where hardly anything was seen.
  [[nodiscard]] double matched_share() const;
  /// The same, but where hardly anything stands upright, the share of the ground alone: a street without walls can hold
  /// a known pose, but not find an unknown one.
  [[nodiscard]] double held_share() const;
  /// The revolution fits the map by `min_share` or more, but some direction in the plane is not constrained.
  [[nodiscard]] bool fits_but_slides(double min_share) const;
};

/// Computes the pose that fits prior and revolution best: Gauss-Newton with a robust kernel for outliers
/// (Geman-McClure). Residual of a ground point: its height over the map's ground. Residual of an upright point: its
/// distance from the nearest upright piece, along the piece's normal if it has one. Residual of a point of paint: its
/// offset from the map's paint.
/// `new_share`: 0..1, the share of the revolution's information that is independent of earlier revolutions.
/// Deterministic.
[[nodiscard]] PoseFit fit_pose(const ThinnedScan& scan, const PoseBelief& prior, fields::SavedMap& map,
                               const TrackingConfig& config, double new_share = 1);

/// A pose moved by a small error, and the error between two poses, in the order of Vector6.
[[nodiscard]] Pose moved_by(const Pose& pose, const Vector6& error);
[[nodiscard]] Vector6 error_between(const Pose& from, const Pose& to);

}  // namespace curbstone::localizer::tracking
