#pragma once

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/model/error_state.hpp"
#include "services/ekf/model/estimate.hpp"
#include "services/ekf/wheel_faults/wheel_dispute.hpp"

namespace curbstone::ekf::filter {

/// What widens a belief where the filter knows less than its covariance says.

/// Speed and tilt have gone astray, and the accelerometer's bias was learnt from them. The gyro's has not: it takes no
/// part in the speed.
void doubt_motion(model::Belief& belief, double speed_sigma, const base::StartConfig& config);
/// The stamps jumped by `gap` s: nobody knows how the vehicle moved meanwhile.
void doubt_since_gap(model::Belief& belief, double gap, const base::StartConfig& config);
/// A process that was killed goes on with what it believed `gap` s ago, on a road vehicle: 3 m/s^2, 1 deg/s of roll and
/// pitch. What is known of the sensors stays known. The belief is moved on by its own velocity.
void doubt_since_killed(model::Belief& belief, double gap);
/// The vehicle may have moved and turned a little before the wheels' travel was noticed: each wheel by anything up to
/// `travel` m, evenly distributed.
void doubt_standstill(model::Belief& belief, double travel, double track_width);

/// It has driven off while the wheels showed no travel, at `speed` m/s: that is the speed, and what way it has made
/// since is not known.
void doubt_wheels_at_rest(model::Belief& belief, double speed);

/// It stands as far as the wheels show, and may have driven off already, at `speed` m/s: until that is found, what is
/// published covers it.
void doubt_standing(model::Estimate& estimate, double speed);

/// All wheels have been found faulty: they have led it astray, and from now on it coasts.
void doubt_astray(model::Belief& belief, const wheel_faults::WheelDispute::Astray& astray,
                  const base::StartConfig& config);

[[nodiscard]] bool is_finite(const model::Belief& belief);

}  // namespace curbstone::ekf::filter
