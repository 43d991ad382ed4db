#pragma once

#include <curbstone/imu_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/pose_t.hpp>
#include <curbstone/wheels_t.hpp>

#include "services/ekf/estimate.hpp"
#include "services/ekf/samples.hpp"

namespace curbstone {

/// Why a message cannot be used: "stamp", "not_finite", "absurd"; nullptr if it can.
[[nodiscard]] const char* why_refused(const imu_t& message);
[[nodiscard]] const char* why_refused(const wheels_t& message);

[[nodiscard]] ImuSample sample_of(const imu_t& message);
[[nodiscard]] WheelSample sample_of(const wheels_t& message);

[[nodiscard]] odometry_t odometry_message(const Estimate& estimate);
/// libbot's pose: velocity, rates and acceleration turned into the local (odom) frame.
[[nodiscard]] pose_t pose_message(const Estimate& estimate);

}  // namespace curbstone
