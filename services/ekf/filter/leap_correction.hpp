#pragma once

#include "services/ekf/detection/gyro_leap.hpp"
#include "services/ekf/detection/tilting_gyro.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::filter {

/// Computes the belief after a leap of the gyro's bias about the vertical: the leap is added to the bias, heading and
/// position are corrected by its effect, and biases, wheel scales and axle are reset to the state before it. The leap's
/// uncertainty widens the covariance.
[[nodiscard]] model::Belief without_leap(model::Belief belief, const detection::GyroLeap::Leap& leap);

/// Computes the belief after a leap about level axes: its state is what gyro, wheels and gravity show without the leap,
/// and the covariance is widened by what they leave open.
[[nodiscard]] model::Belief without_tilt(model::Belief belief, const detection::TiltingGyro::Leap& leap);

}  // namespace curbstone::ekf::filter
