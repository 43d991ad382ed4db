#pragma once

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::filter {

/// The belief, if the IMU is found to be mounted with `yaw` (rad) more than vehicle.imu says: what it has believed of
/// the vehicle's axes is turned by that. The heading and the place are kept, and with them the error of the way from
/// `from` (m, odom), where the vehicle set off with the wrong axes; the covariance covers it.
/// `inertial`: the belief rests on the IMU alone since then, so that its velocity is turned, too.
[[nodiscard]] model::Belief with_turned_imu(model::Belief belief, double yaw, const Eigen::Vector3d& from,
                                            bool inertial);

}  // namespace curbstone::ekf::filter
