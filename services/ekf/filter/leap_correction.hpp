#pragma once

#include "services/ekf/detection/gyro_leap.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::filter {

/// Computes the belief after a leap of the gyro's bias about the vertical: the leap is added to the bias, heading and
/// position are corrected by its effect, and biases, wheel scales and axle are reset to the state before it. The leap's
/// uncertainty widens the covariance.
[[nodiscard]] model::Belief without_leap(model::Belief belief, const detection::GyroLeap::Leap& leap);

}  // namespace curbstone::ekf::filter
