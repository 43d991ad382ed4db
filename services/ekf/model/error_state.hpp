#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "common/geometry/geometry.hpp"

namespace curbstone::ekf::model {

/// The estimated state. The *body* frame has its origin in the IMU and the axes of base_link: an IMU sample needs only
/// a rotation to be used in it, and a wheel only a lever arm.
///
/// The velocity is kept in the body frame (as in pronto's rigid-body state), not in odom: then no measurement of wheels
/// or gravity depends on position or yaw, and the filter cannot become overconfident about them. With the velocity in
/// odom it slowly would.
struct NavState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< p: of the IMU in odom, m
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            ///< v: of the IMU over ground, in body axes, m/s
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< R: body to odom
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           ///< bg: body axes, rad/s
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< ba: body axes, m/s^2
  Eigen::Vector3d wheel_scale = Eigen::Vector3d::Zero();         ///< s: left radius, right radius, track; relative
  double axle = 0.0;                                 ///< m, forward of base_link: the point that does not move sideways
  Eigen::Vector2d course = Eigen::Vector2d::Zero();  ///< c: rolling direction to the left of and above x, rad
};

/// Order of the error state. A true value is the estimate plus its error, except for the attitude, whose error is a
/// rotation vector in body axes, multiplied from the right: R_true = R exp(theta).
///
/// The first 15 errors are the inertial ones. Three are the wheels' calibration: by how much the true radii and track
/// exceed the configured ones. They are nearly constant and hardly observable (the accelerometer shows them a little,
/// the gyro shows their difference), but without them a filter claims centimetres after a kilometre with wheels that
/// are 1 % off, and takes the wheels' turning error for a gyro bias. The last three are the place of the axle that does
/// not slide, and its rolling direction: a base_link 0.76 m ahead of the axle (KITTI's car with base_link below the
/// LiDAR) swings out by 1.2 m in a right turn, and if x points up by half a degree (the same car with the LiDAR's own
/// axes) a filter that models neither sinks by 0.6 m in 70 m.
enum ErrorIndex : int {
  kPosition = 0,
  kVelocity = 3,
  kAttitude = 6,
  kGyroBias = 9,
  kAccelerometerBias = 12,
  kWheelScale = 15,
  kAxle = 18,
  kCourse = 19,
  kErrorSize = 21,
};
using ErrorVector = Eigen::Matrix<double, kErrorSize, 1>;
using ErrorMatrix = Eigen::Matrix<double, kErrorSize, kErrorSize>;

/// state [+] error.
[[nodiscard]] NavState plus(const NavState& state, const ErrorVector& error);
/// The error that takes `from` to `to`: plus(from, minus(to, from)) == to.
[[nodiscard]] ErrorVector minus(const NavState& to, const NavState& from);

/// Covariance of J error: J P J^T for a symmetric P, in the order of the columns and without what J has zeros for: a
/// fraction of the time of Eigen's general product, to run and to compile. For 6 and kErrorSize rows.
template <int Rows>
[[nodiscard]] Eigen::Matrix<double, Rows, Rows> propagated(const Eigen::Matrix<double, Rows, kErrorSize>& J,
                                                           const ErrorMatrix& P);
extern template Eigen::Matrix<double, 6, 6> propagated(const Eigen::Matrix<double, 6, kErrorSize>& J,
                                                       const ErrorMatrix& P);
extern template ErrorMatrix propagated(const ErrorMatrix& J, const ErrorMatrix& P);

/// P = F P F^T for an F of which only the rows of position, velocity and attitude differ from the identity, and a
/// symmetric P.
void propagate_motion(const ErrorMatrix& F, ErrorMatrix& P);

/// The estimate at a time (us) with the covariance of its error. A plain value: a copy of it is a check point.
struct Belief {
  std::int64_t utime = 0;
  NavState mean;
  ErrorMatrix covariance = ErrorMatrix::Zero();
  double imu_turn = 0.0;  ///< rad, ImuSample::turned of the samples that it rests on
};

}  // namespace curbstone::ekf::model
