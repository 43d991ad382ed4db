#pragma once

#include "services/localizer/tracking/pose_fit.hpp"

namespace curbstone::localizer::tracking {

/// The motion since the end of the last revolution.
struct Motion {
  Pose T_last_base = Pose::Identity();
  bool with_odometry = true;
  double seconds = 0;  ///< since the end of the last revolution
};

/// The belief moved by the motion. Odometry's error is added to its covariance, up to a bound.
[[nodiscard]] PoseBelief predicted(const PoseBelief& belief, const Motion& motion, const TrackingConfig& config);

/// Derivative of the error after a motion by the error before it.
[[nodiscard]] Matrix6 motion_jacobian(const Pose& T_map_base, const Motion& motion);

}  // namespace curbstone::localizer::tracking
