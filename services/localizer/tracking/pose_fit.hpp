#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/localizer/fields/saved_map.hpp"
#include "services/localizer/tracking/tracking_config.hpp"

namespace curbstone::localizer::tracking {

/// Rows 0..2: position in map's axes, m; 3..5: rotation about base_link's X Y Z, rad. As in map_pose_t.
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// A pose with what is known of its error.
struct PoseBelief {
  Pose T_map_base = Pose::Identity();
  Matrix6 covariance = Matrix6::Identity();
};

/// What a revolution says of the pose.
struct PoseFit {
  PoseBelief belief;                      ///< prior and revolution together
  Matrix6 information = Matrix6::Zero();  ///< of the revolution alone, were all its points independent
  int degenerate = 0;  ///< bit i: the revolution does not constrain axis i of base_link; see map_pose_t
  int iterations = 0;
  double residual = 0;       ///< m, RMS of what lies where the map has it
  int uprights = 0;          ///< points on something upright, where the map knows the ground about
  int uprights_matched = 0;  ///< of them, with such a thing in the map at that place
  int grounds = 0;           ///< points on the ground, where the map has it
  int grounds_matched = 0;   ///< of them, at that height

  /// 0..1: the lesser of the two shares; 0 where hardly anything was seen.
  [[nodiscard]] double matched_share() const;
  /// The same, but where hardly anything stands, that of the ground alone: a street without walls holds a pose that is
  /// known, and finds none.
  [[nodiscard]] double held_share() const;
};

/// The pose that fits prior and revolution best: Gauss-Newton with a kernel that lets go of what does not fit (Geman,
/// McClure). Ground: height over the map's. Upright: distance from the nearest upright piece, along its normal if it
/// has one. `points`: thinned, in base_link. `new_share`: 0..1, how much of the revolution was not said before.
/// Deterministic.
[[nodiscard]] PoseFit fit_pose(const std::vector<Eigen::Vector3d>& points, const PoseBelief& prior,
                               fields::SavedMap& map, const TrackingConfig& config, double new_share = 1);

/// A pose moved by a small error, and the error between two poses, in the order of Vector6.
[[nodiscard]] Pose moved_by(const Pose& pose, const Vector6& error);
[[nodiscard]] Vector6 error_between(const Pose& from, const Pose& to);

}  // namespace curbstone::localizer::tracking
