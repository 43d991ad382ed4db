#pragma once

#include "common/geometry/gravity.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::model {

/// What an IMU measures, in body axes.
struct Inertial {
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  ///< rad/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< specific force, m/s^2: +g on the up axis at rest
};

/// The state after `dt` seconds of constant rate and specific force:
///
///     w = gyro - bg,  a = acc - ba,  E = exp(w dt),  H = exp(w dt / 2)
///     R' = R E
///     v' = E^T v + H^T a dt + R'^T g dt          (v in body axes: they turn below it)
///     p' = p + R v dt + (R H a + g) dt^2 / 2
[[nodiscard]] NavState integrate(const NavState& state, const Inertial& imu, double dt);

/// The derivative of integrate()'s result by its input error, at `state`: column blocks of F.
[[nodiscard]] ErrorMatrix transition(const NavState& state, const Inertial& imu, double dt);

/// Mean by integrate(), covariance by F P F^T + Q. The noise of gyro and accelerometer enters where their biases do, so
/// that Q follows from the columns of F; biases and wheel scales walk at random.
void predict(Belief& belief, const Inertial& imu, double dt, const base::NoiseConfig& noise);

/// The same while the vehicle stands: it neither turns nor moves, so the gyro is not integrated (it measures its bias
/// only, see observe_standing_rate), nor is what little speed the accelerometer's noise makes between two zero-velocity
/// updates.
void predict_standing(Belief& belief, const Inertial& imu, double dt, const base::NoiseConfig& noise);

/// Without an IMU: base_link keeps its speed, turns at `yaw_rate` (rad/s, from the wheels) and follows the ground, all
/// with large noise.
void predict_coasting(Belief& belief, double yaw_rate, double dt, const base::NoiseConfig& noise);

}  // namespace curbstone::ekf::model
