#pragma once

#include <curbstone/imu_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/pose_t.hpp>
#include <curbstone/wheels_t.hpp>

#include "services/ekf/base/samples.hpp"
#include "services/ekf/model/estimate.hpp"

namespace curbstone::ekf {

/// Why a message is refused: "stamp", "not_finite", "absurd"; nullptr if it is valid.
[[nodiscard]] const char* why_refused(const imu_t& message);
[[nodiscard]] const char* why_refused(const wheels_t& message);

[[nodiscard]] base::ImuSample sample_of(const imu_t& message);
[[nodiscard]] base::WheelSample sample_of(const wheels_t& message);

[[nodiscard]] odometry_t odometry_message(const model::Estimate& estimate);
/// libbot's pose message: velocity, rates and acceleration in the local (odom) frame.
[[nodiscard]] pose_t pose_message(const model::Estimate& estimate);

}  // namespace curbstone::ekf
