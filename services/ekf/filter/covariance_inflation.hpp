#pragma once

#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/model/error_state.hpp"
#include "services/ekf/model/estimate.hpp"
#include "services/ekf/wheel_faults/wheel_dispute.hpp"

namespace curbstone::ekf::filter {

/// Functions that widen a belief where the filter knows less than its covariance says.

/// After speed and tilt have gone wrong, and with them the accelerometer's bias, which was learnt from them. The gyro's
/// bias is kept: it does not depend on the speed.
void inflate_motion_covariance(model::Belief& belief, double speed_sigma, const base::StartConfig& config);
/// After the stamps jumped by `gap` s: the motion in the meantime is unknown.
void inflate_over_gap(model::Belief& belief, double gap, const base::StartConfig& config);
/// For a process that continues from the belief of a killed one, `gap` s old. Assumes a road vehicle: 3 m/s^2, 1 deg/s
/// of roll and pitch. The sensors' calibration keeps its covariance. The belief is moved on with its own velocity, and
/// turned by `turn_rate`, rad/s about the vertical, if that is known.
void extrapolate_over_restart(model::Belief& belief, double gap, std::optional<double> turn_rate);
/// Before the wheels' travel was noticed the vehicle may have moved and turned a little: each wheel by up to `travel`
/// m, evenly distributed.
void inflate_after_standstill(model::Belief& belief, double travel, double track_width);

/// When the vehicle was found to have driven off while the wheels showed no travel: sets its forward speed to `speed`
/// m/s; the distance since then is unknown.
void set_speed_after_missed_start(model::Belief& belief, double speed);

/// While the wheels show a standstill but the vehicle may have driven off already at `speed` m/s: widens the published
/// estimate until that is decided.
void inflate_for_suspected_motion(model::Estimate& estimate, double speed);

/// After all wheels were found faulty: they have pulled the filter off by `error`, and from now on it coasts.
void inflate_for_wheel_faults(model::Belief& belief, const wheel_faults::WheelDispute::FilterError& error,
                              const base::StartConfig& config);

[[nodiscard]] bool is_finite(const model::Belief& belief);

}  // namespace curbstone::ekf::filter
