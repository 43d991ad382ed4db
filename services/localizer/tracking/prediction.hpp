#pragma once

#include "services/localizer/tracking/pose_fit.hpp"

namespace curbstone::localizer::tracking {

/// What is known of the motion since the last revolution's end.
struct Motion {
  Pose T_last_base = Pose::Identity();
  bool with_odometry = true;
  double seconds = 0;  ///< since that end
};

/// The belief taken on by the motion, and what odometry may err by added to its covariance, up to a bound.
[[nodiscard]] PoseBelief predicted(const PoseBelief& belief, const Motion& motion, const TrackingConfig& config);

}  // namespace curbstone::localizer::tracking
