#pragma once

#include "services/ekf/detection/gyro_leap.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::filter {

/// The belief after a leap of the gyro's bias about the vertical: the leap goes into the bias, heading and place are
/// put back to where they would be without it, and biases, wheels and axle to what was learnt before. What the leap is
/// uncertain by widens the covariance.
[[nodiscard]] model::Belief without_leap(model::Belief belief, const detection::GyroLeap::Leap& leap);

}  // namespace curbstone::ekf::filter
