#pragma once

#include "common/geometry/gravity.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::model {

/// An IMU measurement in body axes.
struct Inertial {
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  ///< rad/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< specific force, m/s^2: +g on the up axis at rest
};

/// Computes the state after `dt` seconds of constant rate and specific force:
///
///     w = gyro - bg,  a = acc - ba,  E = exp(w dt),  H = exp(w dt / 2)
///     R' = R E
///     v' = E^T v + H^T a dt + R'^T g dt          (v in body axes: they turn below it)
///     p' = p + R v dt + (R H a + g) dt^2 / 2
[[nodiscard]] NavState integrate(const NavState& state, const Inertial& imu, double dt);

/// Jacobian of integrate()'s result with respect to the input's error, at `state`; F has it in column blocks.
[[nodiscard]] ErrorMatrix transition(const NavState& state, const Inertial& imu, double dt);

/// Predicts the mean with integrate(), the covariance with F P F^T + Q. The noise of gyro and accelerometer enters
/// where their biases do, so Q follows from the columns of F; biases and wheel scales are random walks.
void predict(Belief& belief, const Inertial& imu, double dt, const base::NoiseConfig& noise);

/// Predicts while the vehicle stands: it neither turns nor moves. The gyro is not integrated (it measures only its
/// bias, see observe_standing_rate), nor is the small speed that the accelerometer's noise makes between two
/// zero-velocity updates.
void predict_standing(Belief& belief, const Inertial& imu, double dt, const base::NoiseConfig& noise);

/// Predicts without an IMU: base_link keeps its speed, turns at `yaw_rate` (rad/s, from the wheels) and follows the
/// ground, all with large noise.
void predict_coasting(Belief& belief, double yaw_rate, double dt, const base::NoiseConfig& noise);

}  // namespace curbstone::ekf::model
